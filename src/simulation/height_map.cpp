// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "height_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bin_picking::simulation
{
namespace
{
constexpr float INF = std::numeric_limits<float>::infinity();

std::size_t indexOf(int column, int row, int columns)
{
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
}

void cover(PartProfile& profile, int column, int row, float z)
{
  const auto i = indexOf(column, row, profile.columns);
  profile.lower[i] = std::min(profile.lower[i], z);
  profile.upper[i] = std::max(profile.upper[i], z);
}

/// Where the triangle's projection crosses a line of constant y.
struct Span
{
  float low = INF;
  float high = -INF;

  void cross(const Eigen::Vector3f& a, const Eigen::Vector3f& b, float y)
  {
    if ((a.y() <= y) == (b.y() <= y))
      return;
    const float x = a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    low = std::min(low, x);
    high = std::max(high, x);
  }
};

/// Columns whose centre lies in the triangle's projection. Corners are in units of columns, z in metres.
void coverTriangle(PartProfile& profile, const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c)
{
  const Eigen::Vector3f normal = (b - a).cross(c - a);
  if (std::abs(normal.z()) < 1e-9f)
    return;  // seen from its edge: its corners are enough
  const float low = std::min({a.y(), b.y(), c.y()});
  const float high = std::max({a.y(), b.y(), c.y()});
  for (int row = static_cast<int>(low); row <= std::min(static_cast<int>(high), profile.rows - 1); ++row)
  {
    const float y = static_cast<float>(row) + 0.5f;
    Span span;
    span.cross(a, b, y);
    span.cross(b, c, y);
    span.cross(c, a, y);
    for (int column = static_cast<int>(std::ceil(std::max(span.low - 0.5f, 0.0f)));
         static_cast<float>(column) + 0.5f <= span.high; ++column)
    {
      const float x = static_cast<float>(column) + 0.5f;
      cover(profile, column, row, a.z() - (normal.x() * (x - a.x()) + normal.y() * (y - a.y())) / normal.z());
    }
  }
}

/// The highest of each column and its eight neighbours: keeps one column of air beside steep walls, which the samples
/// in the middle of the columns miss.
std::vector<float> widened(const std::vector<float>& upper, int columns, int rows)
{
  std::vector<float> out(upper.size(), -INF);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      for (int r = std::max(0, row - 1); r <= std::min(rows - 1, row + 1); ++r)
        for (int c = std::max(0, column - 1); c <= std::min(columns - 1, column + 1); ++c)
        {
          float& highest = out[indexOf(column, row, columns)];
          highest = std::max(highest, upper[indexOf(c, r, columns)]);
        }
  return out;
}
}  // namespace

PartProfile profileOf(const TriangleMesh& part, const Eigen::Quaterniond& rotation, double cell)
{
  const Eigen::Matrix3f turn = rotation.toRotationMatrix().cast<float>();
  std::vector<Eigen::Vector3f> vertices;
  vertices.reserve(part.vertices.size());
  Eigen::Vector3f low = Eigen::Vector3f::Constant(INF);
  Eigen::Vector3f high = Eigen::Vector3f::Constant(-INF);
  for (const Eigen::Vector3f& vertex : part.vertices)
  {
    vertices.emplace_back(turn * vertex);
    low = low.cwiseMin(vertices.back());
    high = high.cwiseMax(vertices.back());
  }
  PartProfile profile;
  profile.origin = low.head<2>().cast<double>().array() - cell;  // a rim of one column for the widening
  profile.columns = static_cast<int>((high.x() - low.x()) / cell) + 3;
  profile.rows = static_cast<int>((high.y() - low.y()) / cell) + 3;
  profile.lower.assign(indexOf(0, profile.rows, profile.columns), INF);
  profile.upper.assign(profile.lower.size(), -INF);
  for (Eigen::Vector3f& vertex : vertices)
  {
    vertex.head<2>() = (vertex.head<2>() - profile.origin.cast<float>()) / static_cast<float>(cell);
    cover(profile, static_cast<int>(vertex.x()), static_cast<int>(vertex.y()), vertex.z());
  }
  for (const auto& triangle : part.triangles)
    coverTriangle(profile, vertices[triangle[0]], vertices[triangle[1]], vertices[triangle[2]]);
  profile.upper = widened(profile.upper, profile.columns, profile.rows);
  return profile;
}

HeightMap::HeightMap(double length, double width, double cell)
    : cell_(cell),
      columns_(static_cast<int>(length / cell)),
      rows_(static_cast<int>(width / cell)),
      height_(indexOf(0, rows_, columns_), 0.0f)
{}

double HeightMap::restHeight(const PartProfile& profile, int column, int row) const
{
  float rest = -INF;
  for (int r = 0; r < profile.rows; ++r)
  {
    const float* height = &height_[indexOf(column, row + r, columns_)];
    const float* lower = &profile.lower[indexOf(0, r, profile.columns)];
    for (int c = 0; c < profile.columns; ++c)
      rest = std::max(rest, height[c] - lower[c]);
  }
  return rest;
}

Eigen::Vector3d HeightMap::origin(const PartProfile& profile, int column, int row, double z) const
{
  return {(column - 0.5 * columns_) * cell_ - profile.origin.x(), (row - 0.5 * rows_) * cell_ - profile.origin.y(), z};
}

void HeightMap::add(const PartProfile& profile, int column, int row, double z)
{
  for (int r = 0; r < profile.rows; ++r)
    for (int c = 0; c < profile.columns; ++c)
    {
      float& height = height_[indexOf(column + c, row + r, columns_)];
      const float upper = profile.upper[indexOf(c, r, profile.columns)];
      height = std::max(height, static_cast<float>(z) + upper);
    }
}
}  // namespace bin_picking::simulation
