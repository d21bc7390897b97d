// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/model/distance_field.hpp"
#include "seen_space.hpp"

namespace bin_picking
{
/// The pixels of a part: those whose measured point lies on its surface, and gaps that it alone hides. Told pixel by
/// pixel when asked, since few are.
class OwnPixels
{
public:
  /// \param space, field must outlive it \param tolerance less than the field's band, metres
  OwnPixels(const SeenSpace& space, const DistanceField& field, const Eigen::AlignedBox3f& box_object,
            const Pose& T_camera_object, float tolerance);

  bool at(int u, int v) const;

  /// What is so near to the part's surface is its own, metres.
  float tolerance() const { return tolerance_; }

private:
  bool isOnSurface(std::size_t pixel, int u, int v) const;

  const SeenSpace& space_;
  const DistanceField& field_;
  float tolerance_;
  SeenSpace::Window window_;
  float nearest_;  ///< depths between which the part lies, metres
  float farthest_;
  // From pixels to rays in the part's frame.
  Eigen::Vector3f camera_, corner_, right_, down_;
};
}  // namespace bin_picking
