// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "views.hpp"

#include <filesystem>

#include "bin_picking_perception/scene/cloud_input.hpp"
#include "peer_data.hpp"
#include "random.hpp"
#include "sensor.hpp"

namespace bin_picking::peers
{
namespace
{
constexpr double VIEW_DISTANCE = 0.75;  // metres
constexpr double GROUP_DISTANCE = 1.2;  // metres: eight parts of the size of a hand fit into the picture
constexpr double GROUP_SPACING = 1.3;   // of the diameter
constexpr int GROUP_COLUMNS = 4;

Pose attitude(const PeerModel& model, const Eigen::Vector3d& place, simulation::Random& random)
{
  Pose T_camera_object = Pose::Identity();
  T_camera_object.linear() = random.rotation().toRotationMatrix();
  T_camera_object.translation() = place - T_camera_object.linear() * model.center;
  return T_camera_object;
}

EvaluationScene scan(const PeerModel& model, const std::vector<Pose>& poses, std::uint32_t seed,
                     const std::string& file)
{
  const auto mesh = std::make_shared<const TriangleMesh>(model.mesh);
  std::vector<simulation::SceneObject> objects;
  EvaluationScene scene;
  scene.name = std::filesystem::path(file).stem().string();
  scene.file = file;
  scene.parts = {model.definition.name};
  for (const Pose& pose : poses)
  {
    objects.push_back({mesh, pose});
    TrueInstance instance;
    instance.part = model.definition.name;
    instance.T_camera_object = pose;
    instance.visible_fraction = 1;
    scene.instances.push_back(instance);
  }
  simulation::VirtualSensor sensor(simulation::sensorDefaults(simulation::SensorClass::StructuredLight));
  saveGrid(sensor.scan(objects, seed).grid, file);
  return scene;
}
}  // namespace

std::vector<EvaluationScene> makeViews(const PartDefinition& part, int count, std::uint32_t seed,
                                       const std::string& folder, const std::string& prefix)
{
  const PeerModel model = makePeerModel(part);
  simulation::Random random(seed);
  std::vector<EvaluationScene> scenes;
  for (int k = 0; k < count; ++k)
  {
    const Eigen::Vector3d place(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), VIEW_DISTANCE);
    scenes.push_back(scan(model, {attitude(model, place, random)}, seed + static_cast<std::uint32_t>(k),
                          folder + "/" + prefix + "_" + std::to_string(k + 1) + ".pcd"));
  }
  return scenes;
}

std::vector<EvaluationScene> makeGroups(const PartDefinition& part, const std::vector<int>& copies, std::uint32_t seed,
                                        const std::string& folder, const std::string& prefix)
{
  const PeerModel model = makePeerModel(part);
  simulation::Random random(seed);
  std::vector<EvaluationScene> scenes;
  for (const int count : copies)
  {
    std::vector<Pose> poses;
    for (int k = 0; k < count; ++k)
    {
      const double column = k % GROUP_COLUMNS - 0.5 * (std::min(count, GROUP_COLUMNS) - 1);
      const double row = k / GROUP_COLUMNS - 0.5 * ((count - 1) / GROUP_COLUMNS);
      const double spacing = GROUP_SPACING * model.diameter;
      poses.push_back(attitude(model, {spacing * column, spacing * row, GROUP_DISTANCE}, random));
    }
    scenes.push_back(scan(model, poses, seed + static_cast<std::uint32_t>(count),
                          folder + "/" + prefix + "_" + std::to_string(count) + ".pcd"));
  }
  return scenes;
}
}  // namespace bin_picking::peers
