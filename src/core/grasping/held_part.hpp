// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <optional>

#include "bin_picking_perception/model/distance_field.hpp"
#include "body_sweep.hpp"
#include "column_spans.hpp"

namespace bin_picking
{
/// A part on its straight way out, and what it gets caught on. It lies on others and between them, so that it may touch
/// them all the way; what counts are points that get deeper into it than they are at rest, by more than max_drag.
/// Each check returns the first that it finds, with the depth there (farther on it may be deeper), or nothing met.
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

  /// On another part that rests, by its number.
  Encounter meet(const SurfaceBlocks& other, const Pose& T_camera_other, int index) const;

  /// On a solid side of the bin, by its number: the deepest of the part's points, by as much as it is deeper than the
  /// deepest at rest.
  Encounter meetSide(const ConvexBody& side, ObstacleKind kind, int index) const;

  /// On measured points: visits them in SeenSpace::forEachPoint.
  class AmongPoints
  {
  public:
    /// \param own points so near to the surface are the part's own, metres \param part must outlive this
    AmongPoints(const HeldPart& part, float own);

    /// Most points lie under the part, or beside it.
    bool mayMeet(const Sphere& points_camera) const;
    unsigned mayMeet(const Eigen::Vector3f& ray, float step, const float* depth) const;
    void meet(const Eigen::Vector3f& point_camera);

    const Encounter& met() const { return met_; }

  private:
    const HeldPart& part_;
    float own_;
    ColumnSpans::View view_;
    Encounter met_;
  };

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
  bool mayMeetInObject(const Sphere& points) const;
  Stretch stretchNear(const Eigen::Vector3f& center, const Near& near) const;
  Stretch stretchInBox(const Eigen::Vector3f& center, float radius) const;
  bool staysOutside(const Sphere& points) const;
  float deepening(const Eigen::Vector3f& point_object) const;
  /// Another part that rests, seen from this one.
  struct Neighbour
  {
    Neighbour(const HeldPart& part, const SurfaceBlocks& other, const Pose& T_camera_other);

    const SurfaceBlocks& surface;
    Eigen::Isometry3f T_object_other;
    ColumnSpans::View to_points;   ///< the columns of of_points_
    ColumnSpans::View to_spheres;  ///< and of of_spheres_
  };
  struct Caught
  {
    float deepening;
    std::size_t point;  ///< of the neighbour's surface
  };
  std::optional<Caught> meetBlock(const Neighbour& other, const SurfaceBlocks::Block& block) const;
  Encounter encounter(float deepening, ObstacleKind kind, int index, const Eigen::Vector3f& point_camera) const
  {
    return {-deepening, -max_drag_, kind, index, point_camera};
  }

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
  Near of_points_;
  Near of_spheres_;  ///< up to the radius LARGE
};
}  // namespace bin_picking
