// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "bin_picking_perception/grasping/convex_body.hpp"
#include "bin_picking_perception/grasping/obstacles.hpp"

namespace bin_picking
{
/// Distances of cloud and parts beyond this are not asked for, metres.
constexpr float LOOK_AHEAD = 0.004f;

using Planes = std::vector<Eigen::Vector4f>;

/// Around points that are passed over together. Metres.
struct Sphere
{
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  float radius = 0;
};

/// What a body of the gripper covers while it moves, camera frame, in the forms that the checks read.
struct BodySweep
{
  explicit BodySweep(ConvexBody body) : shape(std::move(body))
  {
    planes.reserve(shape.planes.size());
    for (const Eigen::Vector4d& plane : shape.planes)
      planes.push_back(plane.cast<float>());
    for (const Eigen::Vector3d& v : shape.vertices)
      box.extend(v.cast<float>());
  }

  ConvexBody shape;
  Planes planes;
  Eigen::AlignedBox3f box;
};

/// An obstacle that was met, still without words.
struct Encounter
{
  float distance = std::numeric_limits<float>::infinity();
  float required = 0;
  ObstacleKind kind = ObstacleKind::None;
  int index = -1;  ///< of the part, or of the side of the bin
  Eigen::Vector3f contact = Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());

  float margin() const { return distance - required; }
  bool free() const { return distance >= required; }
};

/// Whether the other matters more. Most of all matters what is not a number: nothing is known of it, so that it is
/// never free.
inline bool isWorse(const Encounter& other, const Encounter& worst)
{
  return !std::isnan(worst.margin()) && !(other.margin() >= worst.margin());
}

inline void keepWorse(Encounter& worst, const Encounter& other)
{
  if (isWorse(other, worst))
    worst = other;
}

/// Of a box in one frame, seen from another.
inline std::vector<Eigen::Vector3f> cornersOf(const Eigen::AlignedBox3f& box, const Eigen::Isometry3f& T)
{
  std::vector<Eigen::Vector3f> corners;
  for (int k = 0; k < 8; ++k)
    corners.push_back(T * box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(k)));
  return corners;
}

/// The planes in the frame from which T leads into theirs.
inline void toFrame(const Eigen::Isometry3f& T, const Planes& planes, Planes& moved)
{
  const Eigen::Matrix3f back = T.linear().transpose();
  const Eigen::Vector3f origin = T.translation();
  moved.resize(planes.size());
  for (std::size_t i = 0; i < planes.size(); ++i)
  {
    const Eigen::Vector3f normal = planes[i].head<3>();
    const Eigen::Vector3f turned = back * normal;
    moved[i] = {turned.x(), turned.y(), turned.z(), planes[i].w() + normal.dot(origin)};
  }
}
}  // namespace bin_picking
