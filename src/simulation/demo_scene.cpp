// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "demo_scene.hpp"

#include <algorithm>

namespace bin_picking::simulation
{
namespace
{
void appendBox(TriangleMesh& mesh, const Eigen::Vector3d& low, const Eigen::Vector3d& high)
{
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int corner = 0; corner < 8; ++corner)
    mesh.vertices.emplace_back(Eigen::Vector3d(corner & 1 ? high.x() : low.x(), corner & 2 ? high.y() : low.y(),
                                               corner & 4 ? high.z() : low.z())
                                   .cast<float>());
  constexpr std::uint32_t FACES[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (const auto& face : FACES)
    mesh.triangles.push_back({first + face[0], first + face[1], first + face[2]});
}

/// Floor and four walls, in the frame of the bin.
TriangleMesh meshOf(const Bin& bin)
{
  const Eigen::Vector3d half(bin.inner_size.x() / 2, bin.inner_size.y() / 2, 0);
  const double wall = bin.wall_thickness;
  const double top = bin.inner_size.z();
  const Eigen::Vector3d outer = half + Eigen::Vector3d(wall, wall, 0);
  TriangleMesh mesh;
  appendBox(mesh, {-outer.x(), -outer.y(), -wall}, {outer.x(), outer.y(), 0});
  if (top <= 0)
    return mesh;
  appendBox(mesh, {-outer.x(), -outer.y(), 0}, {-half.x(), outer.y(), top});
  appendBox(mesh, {half.x(), -outer.y(), 0}, {outer.x(), outer.y(), top});
  appendBox(mesh, {-half.x(), -outer.y(), 0}, {half.x(), -half.y(), top});
  appendBox(mesh, {-half.x(), half.y(), 0}, {half.x(), outer.y(), top});
  return mesh;
}

Bin makeBin(const DemoSceneParameters& parameters)
{
  Bin bin;
  bin.inner_size = {parameters.pile.bin_length, parameters.pile.bin_width, parameters.pile.bin_height};
  // Looking straight down x stays x, while y and z turn round; the tilt then leans the camera about its x axis.
  const Eigen::AngleAxisd down(M_PI, Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd lean(parameters.sensor.tilt, Eigen::Vector3d::UnitX());
  bin.T_camera_bin.linear() = (lean * down).toRotationMatrix();
  bin.T_camera_bin.translation() = Eigen::Vector3d(0, 0, parameters.sensor.distance);
  return bin;
}

int countLabel(const DepthRenderer& view, std::int32_t label)
{
  return static_cast<int>(std::count(view.labels().begin(), view.labels().end(), label));
}

int pixelsAlone(const TriangleMesh& part, const Pose& T_camera_object, const SensorParameters& sensor)
{
  DepthRenderer alone(sensor.width, sensor.height, cameraOf(sensor));
  alone.draw(part, T_camera_object, 0);
  return countLabel(alone, 0);
}

/// Writing a value back through its visitor checks its range.
void checkRanges(DemoSceneParameters parameters)
{
  for (const ParameterEntry& entry : listParameters(visitor(parameters)))
    setParameter(visitor(parameters), entry.path, entry.value);
}
}  // namespace

DemoScene makeDemoScene(const TriangleMesh& part, const DemoSceneParameters& parameters)
{
  checkRanges(parameters);
  const SensorParameters& sensor = parameters.sensor;
  DemoScene scene;
  scene.bin = makeBin(parameters);
  const TriangleMesh bin_mesh = meshOf(scene.bin);
  const Pose T_projector_camera = projectorFromCamera(sensor);
  DepthRenderer view(sensor.width, sensor.height, cameraOf(sensor));
  DepthRenderer projector = makeProjector(sensor);
  const std::vector<Pose> T_bin_objects = layPile(part, parameters.pile);
  const auto bin_label = static_cast<std::int32_t>(T_bin_objects.size());
  view.draw(bin_mesh, scene.bin.T_camera_bin, bin_label);
  projector.draw(bin_mesh, T_projector_camera * scene.bin.T_camera_bin, bin_label);
  for (const Pose& T_bin_object : T_bin_objects)
  {
    DemoInstance instance;
    instance.T_camera_object = scene.bin.T_camera_bin * T_bin_object;
    const auto label = static_cast<std::int32_t>(scene.instances.size());
    view.draw(part, instance.T_camera_object, label);
    projector.draw(part, T_projector_camera * instance.T_camera_object, label);
    scene.instances.push_back(instance);
  }
  for (std::size_t k = 0; k < scene.instances.size(); ++k)
  {
    DemoInstance& instance = scene.instances[k];
    const int alone = pixelsAlone(part, instance.T_camera_object, sensor);
    instance.visible_pixels = countLabel(view, static_cast<std::int32_t>(k));
    instance.visible_fraction = alone > 0 ? static_cast<double>(instance.visible_pixels) / alone : 0;
  }
  scene.grid = measure(view, projector, sensor);
  scene.labels = view.labels();
  std::replace(scene.labels.begin(), scene.labels.end(), bin_label, std::int32_t{-1});
  return scene;
}

void DemoSceneParameters::visit(ParameterVisitor& v)
{
  v.group("pile", pile);
  v.group("sensor", sensor);
}
}  // namespace bin_picking::simulation
