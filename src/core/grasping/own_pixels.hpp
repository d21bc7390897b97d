// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/model/distance_field.hpp"
#include "bin_sides.hpp"
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

/// Whose pixels are whose, for a gripper that takes one of the parts.
class PixelOwners
{
public:
  /// \param parts, sides of the bin: both must outlive this \param tolerance of the bin, metres
  PixelOwners(const SeenSpace& space, const std::vector<OwnPixels>& parts, std::size_t target,
              const std::vector<BinSide>& sides, const Pose& T_bin_camera, float tolerance)
      : space_(space),
        parts_(parts),
        target_(target),
        sides_(sides),
        T_bin_camera_(T_bin_camera.cast<float>()),
        tolerance_(tolerance)
  {}

  bool isOfTarget(int u, int v) const { return parts_[target_].at(u, v); }

  /// Whether a detected part or the bin hides what is behind; also where nothing measured does, as beyond the picture.
  bool isKnown(int u, int v) const;

private:
  const SeenSpace& space_;
  const std::vector<OwnPixels>& parts_;
  std::size_t target_;
  const std::vector<BinSide>& sides_;
  Eigen::Isometry3f T_bin_camera_;
  float tolerance_;
};
}  // namespace bin_picking
