// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <random>

#include "analytic_surfaces.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"

namespace bin_picking
{
namespace test
{
/// The tee of the demo: real enough a part, with a declared half-turn symmetry.
inline PartDefinition teeDefinition()
{
  return loadPart(std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/three_way_tube");
}

/// Trained once per process.
inline const std::shared_ptr<const TrainedModel>& teeModel()
{
  static const auto model = trainPart(teeDefinition(), {}, Executor(2));
  return model;
}

/// A pitch of 0.8 mm at the distance of the parts.
inline PinholeCamera smallCamera() { return {750, 750, 239.5, 191.5}; }

/// Poses of tees that lie apart from each other at 0.6 m, turned at random, but so that the camera sees what tells
/// their pose: the branch (z) not behind the run (x), and the run not end-on.
inline std::vector<Pose> posesApart(std::size_t count, std::uint32_t seed)
{
  std::mt19937 random(seed);
  const Eigen::Vector3d places[] = {{-0.09, -0.07, 0.6}, {0.09, -0.07, 0.6}, {-0.09, 0.07, 0.6}, {0.09, 0.07, 0.6}};
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < count; ++i)
  {
    Pose T = randomPose(random, 0);
    while (T.linear()(2, 2) > 0.3 || std::abs(T.linear()(2, 0)) > 0.7)
      T = randomPose(random, 0);
    T.translation() = places[i] - T.linear() * teeModel()->center;
    poses.push_back(T);
  }
  return poses;
}

/// Floor at 0.66 m, seen straight from above.
inline TriangleMesh floorMesh()
{
  TriangleMesh floor;
  floor.vertices = {{-1, -1, 0.66f}, {1, -1, 0.66f}, {1, 1, 0.66f}, {-1, 1, 0.66f}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  return floor;
}

/// What a camera with the given depth noise sees of parts above a floor.
inline DepthGrid renderParts(const TriangleMesh& part, const std::vector<Pose>& poses, double sigma,
                             std::uint32_t seed = 1)
{
  DepthRenderer renderer(480, 384, smallCamera());
  renderer.draw(floorMesh(), Pose::Identity(), 0);
  for (std::size_t i = 0; i < poses.size(); ++i)
    renderer.draw(part, poses[i], static_cast<std::int32_t>(i + 1));
  DepthGrid grid = renderer.grid();
  std::mt19937 random(seed);
  for (std::size_t i = 0; i < grid.size(); ++i)
  {
    double noise = -6;  // a sum of twelve uniform numbers is close to a normal one
    for (int k = 0; k < 12; ++k)
      noise += uniform(random, 0, 1);
    const auto scale = static_cast<float>(1 + sigma * noise / static_cast<double>(grid.z[i]));
    grid.x[i] *= scale;
    grid.y[i] *= scale;
    grid.z[i] *= scale;
  }
  return grid;
}

inline DepthGrid renderTees(const std::vector<Pose>& poses, double sigma, std::uint32_t seed = 1)
{
  return renderParts(teeModel()->mesh, poses, sigma, seed);
}

/// The bin that the floor belongs to, wide enough for all.
inline Bin wideBin()
{
  Bin bin;
  bin.T_camera_bin.linear() =
      Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();  // z up = towards the camera
  bin.T_camera_bin.translation() = Eigen::Vector3d(0, 0, 0.66);
  bin.inner_size = Eigen::Vector3d(0.4, 0.3, 0.15);
  return bin;
}
}  // namespace test
}  // namespace bin_picking
