// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/grasp_proposal.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "../model/even_directions.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "opposed_points.hpp"

namespace bin_picking
{
namespace
{
constexpr int APPROACHES = 12;            // about a closing axis
constexpr double ROOM = 0.012;            // metres on either side of the part on the way in
constexpr double CONTACT_ENOUGH = 80e-6;  // m^2: more does not make a grasp better
constexpr double COVERED_TILT = M_PI / 4;
constexpr int ATTITUDES = 2000;
constexpr int CONTINUOUS_STEPS = 12;

struct Candidate
{
  GraspDefinition grasp;
  double worth = 0;                 ///< [0, 1]
  std::vector<std::size_t> covers;  ///< attitudes, ascending
};

const std::vector<Eigen::Vector3d>& attitudes()
{
  static const std::vector<Eigen::Vector3d> DIRECTIONS = evenDirections(ATTITUDES);
  return DIRECTIONS;
}

/// The attitudes, as the direction that is down in the part's frame, that one of the variants takes.
std::vector<std::size_t> covered(const std::vector<GraspVariant>& variants, double max_tilt)
{
  const double least = std::cos(max_tilt);
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < attitudes().size(); ++i)
    if (std::any_of(variants.begin(), variants.end(),
                    [&](const GraspVariant& v) { return v.T_object_tip.linear().col(2).dot(attitudes()[i]) >= least; }))
      indices.push_back(i);
  return indices;
}

std::vector<std::size_t> coveredBy(const GraspDefinition& grasp, const Symmetry& symmetry)
{
  PartDefinition alone;
  alone.symmetry = symmetry;
  alone.grasps = {grasp};
  return covered(expandGrasps(alone, CONTINUOUS_STEPS), COVERED_TILT);
}

Eigen::Vector3d centroid(const TriangleMesh& mesh)
{
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double volume = 0;
  for (const auto& t : mesh.triangles)
  {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k)
      corners.col(k) = mesh.vertices[t[static_cast<std::size_t>(k)]].cast<double>();
    volume += corners.determinant();
    sum += corners.determinant() * corners.rowwise().sum() / 4;
  }
  return volume > 0 ? Eigen::Vector3d(sum / volume) : Eigen::Vector3d::Zero();
}

double roundedTo(double value, double step) { return std::round(value / step) * step; }

/// As it can be written down in a few digits, so that what was checked is what is read again.
Pose rounded(const Pose& T)
{
  Pose result = T;
  for (int k = 0; k < 3; ++k)
    result.translation()[k] = roundedTo(T.translation()[k], 1e-4);
  return result;
}

class Proposer
{
public:
  Proposer(const PartDefinition& part, const TriangleMesh& mesh, const Gripper& gripper,
           const GraspCheckParameters& parameters)
      : part_(part),
        gripper_(gripper),
        checker_(mesh, gripper, coarser(parameters)),
        center_(centroid(mesh)),
        size_(largestDistance(mesh.vertices))
  {}

  /// The best grasp, if any, with its approach along a direction at a right angle to the axis of a pair.
  std::optional<Candidate> tryApproach(const OpposedPoints& pair, int step) const
  {
    const Eigen::Vector3d across = pair.axis.unitOrthogonal();
    const Eigen::Vector3d approach = Eigen::AngleAxisd(2 * M_PI * step / APPROACHES, pair.axis) * across;
    Candidate candidate;
    GraspDefinition& grasp = candidate.grasp;
    grasp.T_object_tip.linear().col(2) = approach;
    grasp.T_object_tip.linear().col(1) = pair.axis;
    grasp.T_object_tip.linear().col(0) = pair.axis.cross(approach);
    grasp.T_object_tip.translation() = pair.middle;
    if (!fitFingers(pair.width, grasp))
      return std::nullopt;
    const GraspCheck check = checker_.check(grasp, grasp.T_object_tip);
    if (!check.good())
      return std::nullopt;
    const double contact = std::min(check.right.area, check.left.area);
    const double distance = (grasp.T_object_tip.translation() - center_).norm();
    const double room = grasp.opening / gripper_.max_opening;  // wide fingers find less room among other parts
    candidate.worth = (0.5 * std::min(1.0, contact / CONTACT_ENOUGH) + 0.5 * std::max(0.0, 1 - 2 * distance / size_)) *
                      (1 - 0.5 * room * room);
    addTilt(grasp);
    candidate.covers = coveredBy(grasp, part_.symmetry);
    return candidate;
  }

private:
  static GraspCheckParameters coarser(GraspCheckParameters parameters)
  {
    parameters.resolution = std::max(parameters.resolution, 0.001);
    parameters.surface_spacing = std::max(parameters.surface_spacing, 0.0015);
    return parameters;
  }

  /// Puts the tip into the middle of what the pads meet, twice: the second time they are where they will be.
  bool fitFingers(double width, GraspDefinition& grasp) const
  {
    for (int round = 0; round < 2; ++round)
    {
      if (width > gripper_.max_opening || width < gripper_.min_opening)
        return false;
      GraspCheck measured;
      checker_.measure(grasp.T_object_tip, width, std::min(gripper_.max_opening, width + 2 * ROOM) / 2, measured);
      if (std::isnan(measured.width))
        return false;
      width = measured.width;
      grasp.T_object_tip.translation() += measured.offset * grasp.T_object_tip.linear().col(1);
    }
    grasp.T_object_tip = rounded(grasp.T_object_tip);
    grasp.width = roundedTo(width, 1e-4);
    grasp.opening = std::min(gripper_.max_opening, std::ceil((width + 2 * ROOM) * 1e3) * 1e-3);
    return grasp.width >= gripper_.min_opening && grasp.opening >= grasp.width;
  }

  void addTilt(GraspDefinition& grasp) const
  {
    for (const double tilt : {30.0, 15.0})
    {
      grasp.tilt_tolerance = tilt * M_PI / 180;
      if (checker_.check(grasp).good())
        return;
    }
    grasp.tilt_tolerance = 0;
  }

  const PartDefinition& part_;
  const Gripper& gripper_;
  GraspChecker checker_;
  Eigen::Vector3d center_;
  double size_;
};

/// Takes, one by one, what adds most. \return indices
std::vector<std::size_t> choose(const std::vector<Candidate>& candidates, int count)
{
  std::vector<char> open(static_cast<std::size_t>(ATTITUDES), 1);
  std::vector<std::size_t> chosen;
  while (chosen.size() < static_cast<std::size_t>(count))
  {
    double best_gain = 0;
    std::size_t best = candidates.size();
    for (std::size_t i = 0; i < candidates.size(); ++i)
    {
      const auto& covers = candidates[i].covers;
      const auto added = std::count_if(covers.begin(), covers.end(), [&](std::size_t a) { return open[a] != 0; });
      const double gain = static_cast<double>(added) * candidates[i].worth;
      if (gain > best_gain)
      {
        best_gain = gain;
        best = i;
      }
    }
    if (best == candidates.size())
      break;
    chosen.push_back(best);
    for (const std::size_t attitude : candidates[best].covers)
      open[attitude] = 0;
  }
  return chosen;
}
}  // namespace

double attitudeCoverage(const std::vector<GraspVariant>& variants, double max_tilt)
{
  return static_cast<double>(covered(variants, max_tilt).size()) / ATTITUDES;
}

std::vector<GraspDefinition> proposeGrasps(const PartDefinition& part, const TriangleMesh& mesh, const Gripper& gripper,
                                           const GraspCheckParameters& parameters, int count, const Executor& executor)
{
  if (count < 1)
    throw ParameterError("the number of grasps to propose is " + std::to_string(count) + ", but it must be at least 1");
  const Proposer proposer(part, mesh, gripper, parameters);
  const double spacing = std::max(0.004, largestDistance(mesh.vertices) / 14);
  const std::vector<OpposedPoints> pairs =
      opposedPoints(mesh, gripper.max_opening - 2 * parameters.min_clearance, std::atan(parameters.friction), spacing);
  std::vector<std::optional<Candidate>> tried(pairs.size() * APPROACHES);
  executor.forEach(tried.size(), [&](std::size_t i) {
    tried[i] = proposer.tryApproach(pairs[i / APPROACHES], static_cast<int>(i % APPROACHES));
  });
  std::vector<Candidate> candidates;
  for (std::optional<Candidate>& candidate : tried)
    if (candidate)
      candidates.push_back(std::move(*candidate));

  std::vector<GraspDefinition> grasps;
  for (const std::size_t i : choose(candidates, count))
  {
    GraspDefinition grasp = candidates[i].grasp;
    grasp.id = "proposed_" + std::to_string(grasps.size() + 1);
    grasp.retreat = std::max(grasp.retreat, 0.12);
    grasps.push_back(grasp);
  }
  return grasps;
}
}  // namespace bin_picking
