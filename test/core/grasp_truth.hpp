// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// What a gripper truly touches: its convex sweeps against the triangles of the parts, by exact clipping. Shares nothing
// with the checks of the core but the gripper's description.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "bin_picking_perception/grasping/gripper.hpp"

namespace bin_picking
{
namespace test
{
using Triangle = std::array<Eigen::Vector3d, 3>;

/// Whether a part of the triangle lies inside the body with its faces moved inwards by `shrink`.
inline bool reachesInto(const ConvexBody& body, double shrink, const Triangle& triangle)
{
  std::vector<Eigen::Vector3d> polygon(triangle.begin(), triangle.end());
  std::vector<Eigen::Vector3d> kept;
  for (const Eigen::Vector4d& plane : body.planes)
  {
    const auto height = [&](const Eigen::Vector3d& p) { return plane.head<3>().dot(p) + plane.w() + shrink; };
    kept.clear();
    for (std::size_t i = 0; i < polygon.size(); ++i)
    {
      const Eigen::Vector3d& a = polygon[i];
      const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
      const double ha = height(a);
      const double hb = height(b);
      if (ha <= 0)
        kept.push_back(a);
      if ((ha < 0) != (hb < 0) && ha != hb)
        kept.push_back(a + ha / (ha - hb) * (b - a));
    }
    polygon.swap(kept);
    if (polygon.empty())
      return false;
  }
  return true;
}

/// A part's surface at its true place.
class TruePart
{
public:
  TruePart(const TriangleMesh& mesh, const Pose& T)
  {
    for (const auto& t : mesh.triangles)
    {
      Triangle triangle;
      Eigen::AlignedBox3d box;
      for (std::size_t k = 0; k < 3; ++k)
        box.extend(triangle[k] = T * mesh.vertices[t[k]].cast<double>());
      triangles_.push_back(triangle);
      boxes_.push_back(box);
      box_.extend(box);
    }
  }

  /// How deep the surface lies in the body (a thousandth of a millimetre exactly); 0: they do not touch.
  double depthIn(const ConvexBody& body) const
  {
    Eigen::AlignedBox3d around;
    for (const Eigen::Vector3d& v : body.vertices)
      around.extend(v);
    double depth = 0;
    if (!box_.intersects(around))
      return depth;
    for (std::size_t i = 0; i < triangles_.size(); ++i)
    {
      if (!boxes_[i].intersects(around) || !reachesInto(body, depth, triangles_[i]))
        continue;
      double low = depth;
      double high = MOST;
      while (high - low > 1e-6)
      {
        const double middle = 0.5 * (low + high);
        (reachesInto(body, middle, triangles_[i]) ? low : high) = middle;
      }
      depth = low;
    }
    return depth;
  }

private:
  static constexpr double MOST = 0.05;  ///< metres: deeper is no deeper
  std::vector<Triangle> triangles_;
  std::vector<Eigen::AlignedBox3d> boxes_;
  Eigen::AlignedBox3d box_;
};

/// A body of the gripper on a straight way, frame of T.
inline ConvexBody trueSweep(const Gripper& gripper, std::size_t body, double opening, const Pose& T_frame_tool0,
                            const Eigen::Vector3d& motion)
{
  std::vector<Eigen::Vector3d> corners;
  for (const Eigen::Vector3d& v : gripper.bodyAt(body, opening).vertices)
  {
    corners.push_back(T_frame_tool0 * v);
    corners.push_back(T_frame_tool0 * v + motion);
  }
  return makeHull(corners);
}
}  // namespace test
}  // namespace bin_picking
