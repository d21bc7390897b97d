// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/grasp_expansion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace bin_picking
{
namespace
{
constexpr double SAME_POSITION = 1e-4;           // metres
constexpr double SAME_ANGLE = 0.1 * M_PI / 180;  // rad

/// Shares of the two tolerances, small ones first: 25 samples where there are both.
struct Share
{
  double tilt, spin;
};

std::vector<Share> tolerancedShares()
{
  constexpr std::array<double, 5> SHARES = {0, 0.5, -0.5, 1, -1};
  std::vector<Share> all;
  for (const double spin : SHARES)
    for (const double tilt : SHARES)
      all.push_back({tilt, spin});
  std::stable_sort(all.begin(), all.end(), [](const Share& a, const Share& b) {
    return std::abs(a.tilt) + std::abs(a.spin) < std::abs(b.tilt) + std::abs(b.spin);
  });
  return all;
}

bool usable(const Share& share, const GraspDefinition& grasp)
{
  return (share.tilt == 0 || grasp.tilt_tolerance > 0) && (share.spin == 0 || grasp.spin_tolerance > 0);
}

GraspVariant makeVariant(const GraspDefinition& grasp, const Pose& T_object_symmetric, const Share& share)
{
  GraspVariant variant;
  variant.tilt = share.tilt * grasp.tilt_tolerance;
  variant.spin = share.spin * grasp.spin_tolerance;
  variant.T_object_tip = T_object_symmetric * grasp.T_object_tip *
                         Eigen::AngleAxisd(variant.spin, Eigen::Vector3d::UnitZ()) *
                         Eigen::AngleAxisd(variant.tilt, Eigen::Vector3d::UnitY());
  variant.T_tip_object = variant.T_object_tip.inverse();
  return variant;
}

bool samePose(const Pose& a, const Pose& b)
{
  if ((a.translation() - b.translation()).squaredNorm() > SAME_POSITION * SAME_POSITION)
    return false;
  return Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() < SAME_ANGLE;
}

bool sameFingers(const GraspDefinition& a, const GraspDefinition& b)
{
  return std::abs(a.width - b.width) < SAME_POSITION && std::abs(a.opening - b.opening) < SAME_POSITION;
}

/// Indices of the grasps, the preferred first, so that of two equal poses the preferred one is met first.
std::vector<std::size_t> byPriority(const std::vector<GraspDefinition>& grasps)
{
  std::vector<std::size_t> order(grasps.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return grasps[a].priority > grasps[b].priority; });
  return order;
}
}  // namespace

std::vector<GraspVariant> expandGrasps(const PartDefinition& part, int continuous_steps)
{
  const std::vector<Pose> symmetric_copies = part.symmetry.sampled(continuous_steps);
  std::vector<GraspVariant> variants;
  const auto isKnown = [&](const GraspVariant& candidate) {
    return std::any_of(variants.begin(), variants.end(), [&](const GraspVariant& known) {
      return sameFingers(part.grasps[known.grasp], part.grasps[candidate.grasp]) &&
             samePose(known.T_object_tip, candidate.T_object_tip);
    });
  };
  const std::vector<std::size_t> order = byPriority(part.grasps);
  for (const Share& share : tolerancedShares())
  {
    const auto before = static_cast<std::ptrdiff_t>(variants.size());
    for (const std::size_t g : order)
    {
      const GraspDefinition& grasp = part.grasps[g];
      if (!usable(share, grasp))
        continue;
      const std::size_t copies = grasp.symmetric ? symmetric_copies.size() : 1;
      for (std::size_t s = 0; s < copies; ++s)
      {
        GraspVariant variant = makeVariant(grasp, symmetric_copies[s], share);
        variant.grasp = g;
        variant.symmetry_variant = static_cast<int>(s);
        if (!isKnown(variant))
          variants.push_back(variant);
      }
    }
    std::stable_sort(variants.begin() + before, variants.end(),
                     [](const GraspVariant& a, const GraspVariant& b) { return a.grasp < b.grasp; });
  }
  return variants;
}

std::vector<GraspVariant> expandTolerances(const GraspDefinition& grasp)
{
  PartDefinition alone;
  alone.grasps = {grasp};
  return expandGrasps(alone, 1);
}
}  // namespace bin_picking
