// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/model/distance_field.hpp"
#include "body_sweep.hpp"
#include "column_spans.hpp"

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

  /// Whether any point within the sphere may come near on the way: most lie under the part, or beside it.
  bool mayMeet(const Sphere& points_camera) const
  {
    return mayMeetInObject({T_object_camera_ * points_camera.center, points_camera.radius});
  }

  /// Offers a point that rests in the camera frame: by how much it gets deeper into the part than it is now; no more
  /// than the first depth beyond max_drag that was met.
  /// \param isOwn whether the point is the part's own, asked only of what is near on the way
  template <typename IsOwn>
  void meet(const Eigen::Vector3f& point_camera, ObstacleKind kind, int index, const IsOwn& isOwn,
            Encounter& worst) const
  {
    const Eigen::Vector3f point_object = T_object_camera_ * point_camera;
    const Stretch near = whereNear(point_object, worst.margin() - max_drag_);
    if (!near.isEmpty() && !isOwn())
      keepWorse(worst, {-deepening(point_object, near), -max_drag_, kind, index, point_camera});
  }

  /// The same for all points of another part.
  void meet(const SurfaceBlocks& other, const Pose& T_camera_other, int index, Encounter& worst) const;

  /// The same for the points of this part and a solid side of the bin.
  void meetSide(const ConvexBody& side, ObstacleKind kind, int index, Encounter& worst) const;

private:
  /// A part of the way that others make, seen from the part, metres.
  struct Stretch
  {
    float from;
    float to;

    bool isEmpty() const { return !(from <= to); }
  };
  /// What comes within a distance of the sampled surface, closed, passes through one of these columns.
  struct Near
  {
    float distance;
    ColumnSpans columns;
  };
  Near within(float distance) const { return {distance, columns_.within(distance)}; }
  Stretch whereNear(const Eigen::Vector3f& point_object, float room) const;
  float deepening(const Eigen::Vector3f& point_object, const Stretch& near) const;
  bool mayMeetInObject(const Sphere& points) const;
  Stretch stretchNear(const Eigen::Vector3f& center, const Near& near) const;
  Stretch stretchInBox(const Eigen::Vector3f& center, float radius) const;

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
  ColumnSpans columns_;  ///< of the surface alone
  Near in_sight_;
  Near touching_;
  Near of_spheres_;  ///< up to the radius LARGE
};
}  // namespace bin_picking
