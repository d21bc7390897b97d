// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/model/distance_field.hpp"
#include "body_sweep.hpp"
#include "column_tops.hpp"

namespace bin_picking
{
/// A part on its straight way out, and how deep points of others get into it. It rests on them, so that only what is
/// deeper than at the start counts.
class HeldPart
{
public:
  /// \param spacing of the surface's points, metres \param motion_camera of the part, metres
  HeldPart(const DistanceField& field, const SurfaceBlocks& surface, float spacing, const Pose& T_camera_object,
           const Eigen::Vector3d& motion_camera, float max_drag);

  /// What the part covers on the way lies in here, camera frame.
  const Eigen::AlignedBox3f& box() const { return box_; }
  /// The corners of the part's own box at both ends of the way, camera frame.
  const std::vector<Eigen::Vector3f>& corners() const { return corners_; }

  /// Offers a point that rests in the camera frame: by how much it gets deeper into the part than it is now; no more
  /// than the first depth beyond max_drag that was met.
  void meet(const Eigen::Vector3f& point_camera, ObstacleKind kind, int index, Encounter& worst) const;

  /// The same for all points of another part.
  void meet(const SurfaceBlocks& other, const Pose& T_camera_other, int index, Encounter& worst) const;

  /// The same for the points of this part and a solid side of the bin.
  void meetSide(const ConvexBody& side, ObstacleKind kind, int index, Encounter& worst) const;

private:
  float deepening(const Eigen::Vector3f& point_object) const;
  /// Whether the point may come near on its way: most others lie under the part, and beside it.
  bool mayMeet(const Eigen::Vector3f& point_object) const
  {
    return point_object.dot(way_object_) <= tops_.at(point_object) + LOOK_AHEAD;
  }
  /// The share of the way at which a sphere at rest enters the part's box; > 1: never.
  bool passes(const Eigen::Vector3f& center_object, float radius, float& from, float& to) const;

  const DistanceField& field_;
  const SurfaceBlocks& surface_;
  Eigen::Isometry3f T_object_camera_;
  Eigen::Vector3f way_object_;  ///< of others, seen from the part: unit direction
  Eigen::Vector3f per_way_;     ///< one by that
  float length_;                ///< of the way, metres
  float max_drag_;
  Eigen::Vector3d motion_camera_;
  Eigen::AlignedBox3f box_;
  std::vector<Eigen::Vector3f> corners_;
  ColumnTops tops_;
};
}  // namespace bin_picking
