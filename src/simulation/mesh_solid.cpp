// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "mesh_solid.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace bin_picking::simulation
{
namespace
{
constexpr int ROWS = 128;

/// x at which the line parallel to x through (y, z) goes through the triangle.
std::optional<double> crossing(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, double y,
                               double z)
{
  const auto side = [&](const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    return (p.y() - y) * (q.z() - z) - (q.y() - y) * (p.z() - z);
  };
  const double wa = side(b, c);
  const double wb = side(c, a);
  const double wc = side(a, b);
  const double sum = wa + wb + wc;
  const bool one_side = (wa >= 0 && wb >= 0 && wc >= 0) || (wa <= 0 && wb <= 0 && wc <= 0);
  if (!one_side || sum == 0)
    return std::nullopt;
  return (wa * a.x() + wb * b.x() + wc * c.x()) / sum;
}
}  // namespace

SolidTest::SolidTest(const TriangleMesh& mesh) : mesh_(mesh), rows_(ROWS)
{
  double high = low_ = static_cast<double>(mesh.vertices[0].y());
  for (const Eigen::Vector3f& p : mesh.vertices)
  {
    low_ = std::min(low_, static_cast<double>(p.y()));
    high = std::max(high, static_cast<double>(p.y()));
  }
  step_ = (high - low_) / ROWS;
  for (std::uint32_t k = 0; k < mesh.triangles.size(); ++k)
  {
    const auto& t = mesh.triangles[k];
    const auto [first, last] = std::minmax({mesh.vertices[t[0]].y(), mesh.vertices[t[1]].y(), mesh.vertices[t[2]].y()});
    for (int r = row(static_cast<double>(first)); r <= row(static_cast<double>(last)); ++r)
      rows_[static_cast<std::size_t>(r)].push_back(k);
  }
}

int SolidTest::row(double y) const { return std::clamp(static_cast<int>((y - low_) / step_), 0, ROWS - 1); }

std::vector<double> SolidTest::crossings(double y, double z) const
{
  std::vector<double> places;
  // A hair aside: a line through an edge of the mesh would count it twice or not at all.
  const double beside_y = y + 3.137e-5 * step_;
  const double beside_z = z + 2.271e-5 * step_;
  for (const std::uint32_t k : rows_[static_cast<std::size_t>(row(beside_y))])
  {
    const auto& t = mesh_.triangles[k];
    const auto x = crossing(mesh_.vertices[t[0]].cast<double>(), mesh_.vertices[t[1]].cast<double>(),
                            mesh_.vertices[t[2]].cast<double>(), beside_y, beside_z);
    if (x)
      places.push_back(*x);
  }
  std::sort(places.begin(), places.end());
  return places;
}

bool SolidTest::operator()(const Eigen::Vector3d& point) const
{
  const std::vector<double> places = crossings(point.y(), point.z());
  return (std::lower_bound(places.begin(), places.end(), point.x()) - places.begin()) % 2 == 1;
}
}  // namespace bin_picking::simulation
