// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// A simulated bin with known truth, what a detector would know of it, and random grasps.
#pragma once

#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "bin_picking_perception/grasping/obstacles.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "core/grasp_truth.hpp"
#include "virtual_cell.hpp"

namespace bin_picking
{
namespace test
{
/// How a grasp may be tried: all in the camera frame.
struct TriedGrasp
{
  std::size_t target;  ///< index into BinOfGrasps::placed
  ToolMotion approach;
  ToolMotion retreat;
};

struct BinTrouble
{
  double seen_share = 0.35;      ///< parts of which less is seen are not detected
  double forgotten_share = 0.3;  ///< of the others, at random
  double position_error = 0.0003;
  double angle_error = 0.003;  ///< standard deviations, metres and rad
};

class BinOfGrasps
{
public:
  struct Kind
  {
    PartDefinition definition;
    std::shared_ptr<const TrainedModel> model;
  };

  BinOfGrasps(const std::vector<Kind>& kinds, const std::vector<int>& counts, std::uint32_t seed,
              const simulation::CellParameters& parameters, const BinTrouble& trouble)
      : kinds_(kinds), random_(seed)
  {
    std::vector<simulation::CellPart> parts;
    for (const Kind& kind : kinds)
      parts.push_back({kind.definition.name, std::make_shared<TriangleMesh>(kind.model->mesh)});
    simulation::VirtualCell cell(parts, parameters, 2);
    cell.fill(counts, seed);
    const simulation::CellScan scan = cell.scan(seed);
    bin = cell.bin();
    const PreprocessingParameters preprocessing;
    measured = reduceGrid(scan.scan.grid,
                          reductionFactor(scan.scan.grid, kinds[0].model->parameters.leaf, preprocessing), Executor(2));
    for (const simulation::CellInstance& instance : scan.instances)
    {
      const Kind& kind = kinds[static_cast<std::size_t>(instance.part)];
      truth.emplace_back(kind.model->mesh, instance.T_camera_object);
      if (instance.view.visible_fraction < trouble.seen_share || uniform(0, 1) < trouble.forgotten_share)
        continue;
      placed.push_back({kind.model.get(), disturbed(instance.T_camera_object, kind.model->center, trouble)});
      kind_of_placed_.push_back(static_cast<std::size_t>(instance.part));
      truth_of_placed.push_back(truth.size() - 1);
    }
  }

  /// One of the part's own grasps on a random detection, tilted, turned and opened a little at random; from above.
  TriedGrasp randomGrasp(const Gripper& gripper)
  {
    for (;;)
    {
      const auto k = static_cast<std::size_t>(uniform(0, 1) * static_cast<double>(placed.size()));
      const PartDefinition& definition = kinds_[kind_of_placed_[k]].definition;
      const auto variants = kinds_[kind_of_placed_[k]].model->symmetry.sampled(12);
      const auto g = static_cast<std::size_t>(uniform(0, 1) * static_cast<double>(definition.grasps.size()));
      const auto v = static_cast<std::size_t>(uniform(0, 1) * static_cast<double>(variants.size()));
      const GraspDefinition& grasp = definition.grasps[g];
      const Pose T_tip = placed[k].T_camera_object * variants[v] * grasp.T_object_tip *
                         Eigen::AngleAxisd(uniform(-0.3, 0.3), Eigen::Vector3d::UnitY()) *
                         Eigen::AngleAxisd(uniform(-0.1, 0.1), Eigen::Vector3d::UnitZ());
      const Eigen::Vector3d up = bin.T_camera_bin.linear().col(2);
      const Eigen::Vector3d approach = T_tip.linear().col(2);
      if (-approach.dot(up) < std::cos(0.8))
        continue;
      TriedGrasp tried;
      tried.target = k;
      const double opening =
          std::min(gripper.max_opening, std::max(grasp.width + 0.004, grasp.opening + uniform(-0.015, 0.01)));
      tried.retreat = {T_tip * gripper.T_tool0_tip(grasp.width).inverse(), grasp.retreat * up, grasp.width};
      tried.approach = {Eigen::Translation3d(-grasp.approach * approach) * tried.retreat.T_camera_tool0,
                        grasp.approach * approach, opening};
      return tried;
    }
  }

  double uniform(double low, double high) { return low + (high - low) * (random_() / 4294967296.0); }

  Bin bin;
  DepthGrid measured;
  std::vector<PlacedPart> placed;            ///< what was detected
  std::vector<TruePart> truth;               ///< all that lies in the bin, camera frame
  std::vector<std::size_t> truth_of_placed;  ///< index into truth

private:
  double normal() { return std::sqrt(-2 * std::log(1 - uniform(0, 1))) * std::cos(2 * M_PI * uniform(0, 1)); }
  Pose disturbed(const Pose& T, const Eigen::Vector3d& center, const BinTrouble& trouble)
  {
    const Eigen::Vector3d shift = trouble.position_error * Eigen::Vector3d(normal(), normal(), normal());
    const Eigen::Vector3d turn = trouble.angle_error * Eigen::Vector3d(normal(), normal(), normal());
    const Eigen::Translation3d to_center(center);
    return Eigen::Translation3d(shift) * T * to_center *
           Eigen::AngleAxisd(turn.norm(), turn.norm() > 0 ? turn.normalized() : Eigen::Vector3d::UnitX()) *
           to_center.inverse();
  }

  std::vector<Kind> kinds_;
  std::mt19937 random_;
  std::vector<std::size_t> kind_of_placed_;
};

/// How deep the gripper truly gets into parts, worst over a grasp's way in.
inline double trueApproachDepth(const BinOfGrasps& bin, const Gripper& gripper, const TriedGrasp& grasp)
{
  double depth = 0;
  for (std::size_t body = 0; body < gripper.bodies.size(); ++body)
  {
    const ConvexBody sweep =
        trueSweep(gripper, body, grasp.approach.opening, grasp.approach.T_camera_tool0, grasp.approach.motion_camera);
    for (const TruePart& part : bin.truth)
      depth = std::max(depth, part.depthIn(sweep));
  }
  return depth;
}

/// The same while the fingers close, in small steps; the fingers may touch the target.
inline double trueClosingDepth(const BinOfGrasps& bin, const Gripper& gripper, const TriedGrasp& grasp)
{
  double depth = 0;
  constexpr double STEP = 0.002;
  for (double opening = grasp.approach.opening; opening >= grasp.retreat.opening; opening -= STEP)
    for (std::size_t body = 0; body < gripper.bodies.size(); ++body)
    {
      if (gripper.bodies[body].placements.size() < 2)
        continue;
      const ConvexBody shape = transformed(gripper.bodyAt(body, opening), grasp.retreat.T_camera_tool0);
      for (std::size_t i = 0; i < bin.truth.size(); ++i)
        if (i != bin.truth_of_placed[grasp.target] || !gripper.bodies[body].touches_part)
          depth = std::max(depth, bin.truth[i].depthIn(shape));
    }
  return depth;
}

/// The same on the way out, the target aside.
inline double trueRetreatDepth(const BinOfGrasps& bin, const Gripper& gripper, const TriedGrasp& grasp)
{
  double depth = 0;
  for (std::size_t body = 0; body < gripper.bodies.size(); ++body)
  {
    const ConvexBody sweep =
        trueSweep(gripper, body, grasp.retreat.opening, grasp.retreat.T_camera_tool0, grasp.retreat.motion_camera);
    for (std::size_t i = 0; i < bin.truth.size(); ++i)
      if (i != bin.truth_of_placed[grasp.target])
        depth = std::max(depth, bin.truth[i].depthIn(sweep));
  }
  return depth;
}
}  // namespace test
}  // namespace bin_picking
