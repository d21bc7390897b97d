// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <bitset>
#include <optional>
#include <vector>

#include "candidate_checks.hpp"
#include "grasp_ranking.hpp"
#include "prepared_part.hpp"

namespace bin_picking
{
/// The grasps of one detection, as far as they were looked at.
class DetectionGrasps
{
public:
  /// All but the index must outlive this.
  DetectionGrasps(std::size_t index, const PartDefinition& definition, const PreparedPart& part,
                  const GraspSurroundings& s);

  /// All grasps as written, and their copies around axes and by symmetry. Of the copies of a grasp that are too steep,
  /// half of them as a rule, the least steep is listed for all.
  void tryAsWritten();

  /// Those that use a tolerance, up to the first few that are allowed. One that is not is listed if no other of its
  /// grasp was rejected for the like: there may be thousands, and they differ by little.
  void tryTurned();

  /// Whether turning may help: nothing is allowed, and no reason holds for all grasps.
  bool isWithoutGrasp() const { return allowed.empty() && refusal_.rejection == GraspRejection::None; }

  std::vector<GraspCandidate> allowed;  ///< in the order of the variants, not yet ranked
  std::vector<Grasp> rejected;

private:
  const Refusal& refusalOf(std::size_t g) const;
  void refuse(std::size_t v, const Refusal& refusal);
  void asWritten(std::size_t v);
  void turned(std::size_t v);
  bool isListed(std::size_t g, GraspRejection rejection) const;
  bool steeper(std::size_t v, std::size_t than) const;
  double tiltOf(std::size_t v) const;
  bool isTooSteep(std::size_t v) const;
  bool isHeldDown(std::size_t g) const;
  bool passes(Grasp& grasp, std::size_t g);
  bool isFree(Grasp& grasp, std::size_t g) const;
  bool comesOut(Grasp& grasp, std::size_t g);
  bool isReached(Grasp& grasp) const;
  Eigen::Vector3d outOf(const Grasp& grasp, std::size_t g) const;
  Eigen::Vector3d awayFrom(const Pose& T_camera_grasp) const;
  Grasp makeGrasp(std::size_t v) const;
  GraspWay wayThrough(const Pose& T_camera_grasp, const GraspDefinition& definition) const;
  void allow(Grasp&& grasp, std::size_t g);
  void list(Grasp&& grasp, std::size_t g);

  const GraspSurroundings& s_;
  std::size_t index_;
  const Detection& detection_;
  const PartDefinition& definition_;
  const PreparedPart& part_;
  Eigen::Vector3d up_object_;
  double over_rim_;      ///< how far the part has to be lifted to be out of the bin, metres; < 0 without a bin
  double least_cosine_;  ///< of the tilt, less rounding
  std::vector<std::bitset<32>> listed_;  ///< per grasp as written, by rejection
  std::optional<WayOut> way_out_;
  Refusal refusal_;  ///< of all grasps
};
}  // namespace bin_picking
