// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "bin_picking_perception/grasping/grasp_check.hpp"

namespace bin_picking
{
namespace
{
constexpr double NO_HIT = -std::numeric_limits<double>::infinity();

/// Lines along Y of the tip frame, on a grid in X and Z.
struct LineGrid
{
  Eigen::Vector2d low;  ///< x, z of the first line
  double step = 0;
  int columns = 0, rows = 0;

  Eigen::Vector2d at(int column, int row) const { return low + step * Eigen::Vector2d(column, row); }
  std::size_t index(int column, int row) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
  }
};

/// What one pad sees of the part: depths are along the way of the pad towards the part, larger is met first.
struct PadView
{
  double side = 1;           ///< +1: the pad at +Y
  std::vector<double> face;  ///< per line: Y of the pad's face beyond half the width; infinite where there is no pad
  std::vector<double> met;   ///< per line: position of the surface less the pad's profile, times the side
  std::vector<Eigen::Vector3d> normals;
};

/// The interval of Y in which a line along Y is inside a body; empty: low > high.
std::pair<double, double> cut(const ConvexBody& body, const Eigen::Vector2d& xz)
{
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  for (const Eigen::Vector4d& plane : body.planes)
  {
    const double rest = plane.x() * xz.x() + plane.z() * xz.y() + plane.w();
    if (std::abs(plane.y()) < 1e-12)
    {
      if (rest > 0)
        return {1, -1};
    }
    else if (plane.y() > 0)
      high = std::min(high, -rest / plane.y());
    else
      low = std::max(low, -rest / plane.y());
  }
  return {low, high};
}

std::vector<ConvexBody> padsInTip(const Gripper& gripper, double width)
{
  const Pose T_tip_tool0 = gripper.T_tool0_tip(width).inverse();
  std::vector<ConvexBody> pads;
  for (std::size_t b = 0; b < gripper.bodies.size(); ++b)
    if (gripper.bodies[b].touches_part)
      pads.push_back(transformed(gripper.bodyAt(b, width), T_tip_tool0));
  return pads;
}

double sideOf(const ConvexBody& pad)
{
  double sum = 0;
  for (const Eigen::Vector3d& v : pad.vertices)
    sum += v.y();
  return sum < 0 ? -1 : 1;
}

LineGrid coveringGrid(const std::vector<ConvexBody>& pads, double step)
{
  Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const ConvexBody& pad : pads)
    for (const Eigen::Vector3d& v : pad.vertices)
    {
      low = low.cwiseMin(Eigen::Vector2d(v.x(), v.z()));
      high = high.cwiseMax(Eigen::Vector2d(v.x(), v.z()));
    }
  LineGrid grid;
  grid.step = step;
  grid.columns = std::max(1, static_cast<int>((high.x() - low.x()) / step));
  grid.rows = std::max(1, static_cast<int>((high.y() - low.y()) / step));
  // In the middle of its pad, so that both rims are left out alike.
  grid.low = (low + high - step * Eigen::Vector2d(grid.columns - 1, grid.rows - 1)) / 2;
  return grid;
}

PadView emptyView(const std::vector<ConvexBody>& pads, double side, double width, const LineGrid& grid)
{
  PadView view;
  view.side = side;
  const std::size_t size = grid.index(0, grid.rows);
  view.face.assign(size, std::numeric_limits<double>::infinity());
  view.met.assign(size, NO_HIT);
  view.normals.assign(size, Eigen::Vector3d::Zero());
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      for (const ConvexBody& pad : pads)
        if (sideOf(pad) == side)
          if (const auto [low, high] = cut(pad, grid.at(column, row)); low <= high)
          {
            double& face = view.face[grid.index(column, row)];
            face = std::min(face, (side > 0 ? low : -high) - width / 2);
          }
  return view;
}

/// Marks where the lines meet a triangle. \param reach what is farther than this from the middle is not between the
/// pads
void meet(const std::array<Eigen::Vector3d, 3>& corners, const LineGrid& grid, double reach, PadView& view)
{
  const Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (!(normal.y() * view.side > 0))  // looks away from the pad, or along it
    return;
  Eigen::Vector3d low = corners[0], high = corners[0];
  for (const Eigen::Vector3d& corner : corners)
  {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  const auto first = [&](double value, int axis) {
    return std::max(0, static_cast<int>(std::ceil((value - grid.low[axis]) / grid.step - 1e-9)));
  };
  const auto last = [&](double value, int axis, int count) {
    return std::min(count - 1, static_cast<int>(std::floor((value - grid.low[axis]) / grid.step + 1e-9)));
  };
  for (int row = first(low.z(), 1); row <= last(high.z(), 1, grid.rows); ++row)
    for (int column = first(low.x(), 0); column <= last(high.x(), 0, grid.columns); ++column)
    {
      const std::size_t i = grid.index(column, row);
      if (std::isinf(view.face[i]))
        continue;
      const Eigen::Vector2d p = grid.at(column, row);
      bool inside = true;
      for (std::size_t k = 0; k < 3 && inside; ++k)
      {
        const Eigen::Vector3d& a = corners[k];
        const Eigen::Vector3d& b = corners[(k + 1) % 3];
        const double turn = (b.z() - a.z()) * (p.x() - a.x()) - (b.x() - a.x()) * (p.y() - a.z());
        inside = turn * view.side >= -1e-15;  // seen along Y the triangle runs counter-clockwise if it looks to +Y
      }
      if (!inside)
        continue;
      const double y =
          corners[0].y() - (normal.x() * (p.x() - corners[0].x()) + normal.z() * (p.y() - corners[0].z())) / normal.y();
      const double met = view.side * y - view.face[i];
      if (std::abs(y) <= reach && met > view.met[i])
      {
        view.met[i] = met;
        view.normals[i] = normal.normalized();
      }
    }
}

PadContact contactOf(const PadView& view, const LineGrid& grid, const GraspCheckParameters& parameters)
{
  PadContact contact;
  const double first = *std::max_element(view.met.begin(), view.met.end());
  if (first == NO_HIT)
  {
    contact.position = contact.angle = std::numeric_limits<double>::quiet_NaN();
    return contact;
  }
  const double steepest = std::cos(std::atan(parameters.friction));
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(), center = Eigen::Vector3d::Zero();
  int lines = 0, held = 0;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
    {
      const std::size_t i = grid.index(column, row);
      if (view.met[i] < first - parameters.compliance)
        continue;
      ++lines;
      normal += view.normals[i];
      const Eigen::Vector2d p = grid.at(column, row);
      center += Eigen::Vector3d(p.x(), view.side * view.met[i], p.y());
      held += view.normals[i].y() * view.side >= steepest ? 1 : 0;
    }
  contact.position = view.side * first;
  contact.area = held * grid.step * grid.step;
  contact.angle = std::acos(std::clamp(view.side * normal.normalized().y(), -1.0, 1.0));
  contact.center = center / lines;
  return contact;
}
}  // namespace

void GraspChecker::measure(const Pose& T_object_tip, double width, double reach, GraspCheck& result) const
{
  const std::vector<ConvexBody> pads = padsInTip(gripper_, width);
  const LineGrid grid = coveringGrid(pads, parameters_.resolution);
  PadView right = emptyView(pads, 1, width, grid), left = emptyView(pads, -1, width, grid);
  const Pose T_tip_object = T_object_tip.inverse();
  std::vector<Eigen::Vector3d> vertices;
  vertices.reserve(mesh_.vertices.size());
  for (const Eigen::Vector3f& v : mesh_.vertices)
    vertices.push_back(T_tip_object * v.cast<double>());
  for (const auto& triangle : mesh_.triangles)
  {
    const std::array<Eigen::Vector3d, 3> corners = {vertices[triangle[0]], vertices[triangle[1]],
                                                    vertices[triangle[2]]};
    meet(corners, grid, reach, right);
    meet(corners, grid, reach, left);
  }
  result.right = contactOf(right, grid, parameters_);
  result.left = contactOf(left, grid, parameters_);
  result.width = result.right.position - result.left.position;
  result.offset = (result.right.position + result.left.position) / 2;
}
}  // namespace bin_picking
