// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "tiled_points.hpp"

#include <algorithm>
#include <array>

#include "../common/simd.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t LANES = Neighbourhood::LANES;
constexpr float TILE = 0.5f;  // of the radius: smaller ones hold less that is too far away, in more runs

enum Sum : std::size_t
{
  N,
  X,
  Y,
  Z,
  XX,
  XY,
  XZ,
  YY,
  YZ,
  ZZ
};
constexpr std::size_t NUM_SUMS = ZZ + 1;
using LaneSums = std::array<std::array<float, LANES>, NUM_SUMS>;

struct Query
{
  float x, y, z, nx, ny, nz, squared_radius, min_cosine;
};

BIN_PICKING_SIMD void addMoments(const PointPlanes& planes, std::size_t begin, std::size_t end, const Query& given,
                                 LaneSums& result)
{
  // Local copies, because what lies behind a reference might be one of the sums.
  LaneSums sums = result;
  const Query q = given;
  for (std::size_t k = begin; k < end; k += LANES)
    for (std::size_t l = 0; l < LANES; ++l)
    {
      const std::size_t i = k + l;
      const float dx = planes.x[i] - q.x;
      const float dy = planes.y[i] - q.y;
      const float dz = planes.z[i] - q.z;
      const float cosine = planes.nx[i] * q.nx + planes.ny[i] * q.ny + planes.nz[i] * q.nz;
      const bool counts = (i < end) & (dx * dx + dy * dy + dz * dz < q.squared_radius) & (cosine >= q.min_cosine);
      const float w = counts ? 1.0f : 0.0f;
      const float x = w * dx;
      const float y = w * dy;
      const float z = w * dz;
      sums[N][l] += w;
      sums[X][l] += x;
      sums[Y][l] += y;
      sums[Z][l] += z;
      sums[XX][l] += x * dx;
      sums[XY][l] += x * dy;
      sums[XZ][l] += x * dz;
      sums[YY][l] += y * dy;
      sums[YZ][l] += y * dz;
      sums[ZZ][l] += z * dz;
    }
  result = sums;
}

double total(const std::array<float, LANES>& lanes)
{
  double sum = 0;
  for (const float lane : lanes)
    sum += static_cast<double>(lane);
  return sum;
}

/// In the order of the tiles, and as many zeros behind as a loop over whole vectors may read.
template <typename Coordinate>
std::vector<float> plane(const std::vector<int>& order, const Coordinate& coordinate)
{
  std::vector<float> values(order.size() + LANES, 0.0f);
  std::transform(order.begin(), order.end(), values.begin(),
                 [&](int i) { return coordinate(static_cast<std::size_t>(i)); });
  return values;
}
}  // namespace

TiledPoints::TiledPoints(const OrientedPoints& points, float radius)
    : radius_(radius),
      tiles_(points.points, TILE * radius),
      x_(plane(tiles_.order(), [&](std::size_t i) { return points.points[i].x(); })),
      y_(plane(tiles_.order(), [&](std::size_t i) { return points.points[i].y(); })),
      z_(plane(tiles_.order(), [&](std::size_t i) { return points.points[i].z(); })),
      nx_(plane(tiles_.order(), [&](std::size_t i) { return points.normals[i].x(); })),
      ny_(plane(tiles_.order(), [&](std::size_t i) { return points.normals[i].y(); })),
      nz_(plane(tiles_.order(), [&](std::size_t i) { return points.normals[i].z(); }))
{}

PlaneMoments TiledPoints::planeMoments(const Eigen::Vector3f& query, const Eigen::Vector3f& normal,
                                       float min_cosine) const
{
  LaneSums sums{};
  const PointPlanes planes = this->planes();
  const Query q{query.x(), query.y(), query.z(), normal.x(), normal.y(), normal.z(), radius_ * radius_, min_cosine};
  tiles_.forEachRun(query, radius_,
                    [&](std::size_t begin, std::size_t end) { addMoments(planes, begin, end, q, sums); });
  PlaneMoments moments;
  moments.count = total(sums[N]);
  moments.sum << total(sums[X]), total(sums[Y]), total(sums[Z]);
  moments.products << total(sums[XX]), total(sums[XY]), total(sums[XZ]),  //
      total(sums[XY]), total(sums[YY]), total(sums[YZ]),                  //
      total(sums[XZ]), total(sums[YZ]), total(sums[ZZ]);
  return moments;
}

QuadricMoments TiledPoints::quadricMoments(const Eigen::Vector3f& query, const Eigen::Vector3f& normal,
                                           const Eigen::Matrix3f& frame, float min_cosine) const
{
  QuadricSums sums;
  const QuadricQuery q{query, normal, frame, radius_, min_cosine};
  tiles_.forEachRun(query, radius_, [&](std::size_t begin, std::size_t end) { sums.add(planes(), begin, end, q); });
  return sums.moments();
}

std::size_t TiledPoints::gather(std::size_t begin, std::size_t end, const Eigen::Vector3f& query,
                                const Eigen::Vector3f& normal, float min_cosine, Neighbourhood& found) const
{
  std::size_t size = found.size;
  for (; begin < end && size < Neighbourhood::CAPACITY; ++begin)
  {
    const Eigen::Vector3f offset = Eigen::Vector3f(x_[begin], y_[begin], z_[begin]) - query;
    const Eigen::Vector3f other(nx_[begin], ny_[begin], nz_[begin]);
    // Written in any case, kept if it counts: no branch to be guessed wrong.
    found.x[size] = offset.x();
    found.y[size] = offset.y();
    found.z[size] = offset.z();
    found.nx[size] = other.x();
    found.ny[size] = other.y();
    found.nz[size] = other.z();
    found.weight[size] = 1;
    const bool is_near = offset.squaredNorm() < radius_ * radius_;
    const bool faces_alike = other.dot(normal) >= min_cosine;
    size += static_cast<std::size_t>(is_near) & static_cast<std::size_t>(faces_alike);
  }
  found.size = size;
  return begin;
}
}  // namespace bin_picking
