// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "own_pixels.hpp"

#include <algorithm>
#include <cmath>

namespace bin_picking
{
OwnPixels::OwnPixels(const SeenSpace& space, const DistanceField& field, const Eigen::AlignedBox3f& box_object,
                     const Pose& T_camera_object, float tolerance)
    : space_(space), field_(field), tolerance_(tolerance)
{
  const std::vector<Eigen::Vector3f> corners = cornersOf(box_object, Eigen::Isometry3f(T_camera_object.cast<float>()));
  const auto [front, back] = std::minmax_element(
      corners.begin(), corners.end(), [](const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return a.z() < b.z(); });
  nearest_ = front->z() - tolerance;
  farthest_ = back->z() + tolerance;
  window_ = space.windowOf(corners, tolerance);
  const Eigen::Isometry3f T_object(T_camera_object.inverse().cast<float>());
  camera_ = T_object.translation();
  right_ = T_object.linear().col(0) * space.step_.x();
  down_ = T_object.linear().col(1) * space.step_.y();
  corner_ = T_object.linear() * space.ray(0, 0);
}

bool OwnPixels::at(int u, int v) const
{
  if (!window_.contains(u, v))
    return false;
  const std::int32_t hider = space_.hiderOf(u, v);
  if (hider < 0)
    return false;
  const auto [at_u, at_v] = space_.pixelOf(hider);
  return isOnSurface(static_cast<std::size_t>(hider), at_u, at_v);
}

bool OwnPixels::isOnSurface(std::size_t pixel, int u, int v) const
{
  const float depth = space_.depth_[pixel];
  if (depth < nearest_ || depth > farthest_)
    return false;
  const Eigen::Vector3f ray = corner_ + static_cast<float>(u) * right_ + static_cast<float>(v) * down_;
  return std::abs(field_.at(camera_ + depth * ray)) <= tolerance_;
}

bool PixelOwners::isKnown(int u, int v) const
{
  const std::int32_t hider = space_.hiderOf(u, v);
  if (hider < 0)
    return true;
  const auto [at_u, at_v] = space_.pixelOf(hider);  // a part's own gaps may lie beside its silhouette
  if (std::any_of(parts_.begin(), parts_.end(), [u = at_u, v = at_v](const OwnPixels& part) { return part.at(u, v); }))
    return true;
  const Eigen::Vector3d point = (T_bin_camera_ * space_.pointAt(at_u, at_v)).cast<double>();
  return std::any_of(sides_.begin(), sides_.end(), [&](const BinSide& side) {
    return side.box_bin.exteriorDistance(point) <= static_cast<double>(tolerance_);
  });
}
}  // namespace bin_picking
