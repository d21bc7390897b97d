// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "quadric_fit.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "../common/simd.hpp"
#include "bin_picking_perception/scene/curvature.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t LANES = Neighbourhood::LANES;
constexpr std::size_t NUM_SUMS = QuadricMoments::NUM_POWERS + QuadricMoments::NUM_RIGHT;
constexpr std::size_t ORDER = 6;
/// Smallest pivot per point of the normal equations; below, the points form a strip that fixes no quadric.
constexpr double MIN_PIVOT = 1e-4;

/// Places of the sums: first the powers of x and y, then z times those up to the second order.
enum Sum : std::size_t
{
  N,
  X,
  Y,
  X2,
  XY,
  Y2,
  X3,
  X2Y,
  XY2,
  Y3,
  X4,
  X3Y,
  X2Y2,
  XY3,
  Y4,
  ZX2,
  ZXY,
  ZY2,
  ZX,
  ZY,
  Z
};

using LaneSums = std::array<std::array<float, LANES>, NUM_SUMS>;

/// The sums' terms of one point. \param weight 1, or 0 for a point that does not count
BIN_PICKING_INLINE void addPoint(LaneSums& sums, std::size_t l, float weight, float px, float py, float pz,
                                 const float* frame)
{
  const float x = frame[0] * px + frame[1] * py + frame[2] * pz;
  const float y = frame[3] * px + frame[4] * py + frame[5] * pz;
  const float z = frame[6] * px + frame[7] * py + frame[8] * pz;
  const float xx = x * x;
  const float xy = x * y;
  const float yy = y * y;
  sums[N][l] += weight;
  sums[X][l] += x;
  sums[Y][l] += y;
  sums[X2][l] += xx;
  sums[XY][l] += xy;
  sums[Y2][l] += yy;
  sums[X3][l] += xx * x;
  sums[X2Y][l] += xx * y;
  sums[XY2][l] += x * yy;
  sums[Y3][l] += yy * y;
  sums[X4][l] += xx * xx;
  sums[X3Y][l] += xx * xy;
  sums[X2Y2][l] += xx * yy;
  sums[XY3][l] += xy * yy;
  sums[Y4][l] += yy * yy;
  sums[ZX2][l] += z * xx;
  sums[ZXY][l] += z * xy;
  sums[ZY2][l] += z * yy;
  sums[ZX][l] += z * x;
  sums[ZY][l] += z * y;
  sums[Z][l] += z;
}

BIN_PICKING_SIMD void sumMoments(const Neighbourhood& found, const float* given_frame, const float* given_normal,
                                 float min_cosine, LaneSums& result)
{
  // Local copies, because what lies behind a pointer might be one of the sums.
  LaneSums sums{};
  float frame[9];
  float normal[3];
  std::copy_n(given_frame, 9, frame);
  std::copy_n(given_normal, 3, normal);
  for (std::size_t k = 0; k < found.size; k += LANES)
    for (std::size_t l = 0; l < LANES; ++l)
    {
      const std::size_t i = k + l;
      const float cosine = normal[0] * found.nx[i] + normal[1] * found.ny[i] + normal[2] * found.nz[i];
      const float weight = found.weight[i] * static_cast<float>(cosine >= min_cosine);
      addPoint(sums, l, weight, weight * found.x[i], weight * found.y[i], weight * found.z[i], frame);
    }
  result = sums;
}

BIN_PICKING_SIMD void sumMomentsWithin(const PointPlanes& given_planes, std::size_t begin, std::size_t end,
                                       const float* given_point, const float* given_normal, const float* given_frame,
                                       float squared_radius, float min_cosine, LaneSums& result)
{
  LaneSums sums = result;
  const PointPlanes planes = given_planes;
  float point[3];
  float normal[3];
  float frame[9];
  std::copy_n(given_point, 3, point);
  std::copy_n(given_normal, 3, normal);
  std::copy_n(given_frame, 9, frame);
  for (std::size_t k = begin; k < end; k += LANES)
    for (std::size_t l = 0; l < LANES; ++l)
    {
      const std::size_t i = k + l;
      const float dx = planes.x[i] - point[0];
      const float dy = planes.y[i] - point[1];
      const float dz = planes.z[i] - point[2];
      const float cosine = normal[0] * planes.nx[i] + normal[1] * planes.ny[i] + normal[2] * planes.nz[i];
      const bool counts = (i < end) & (dx * dx + dy * dy + dz * dz < squared_radius) & (cosine >= min_cosine);
      const float weight = counts ? 1.0f : 0.0f;
      addPoint(sums, l, weight, weight * dx, weight * dy, weight * dz, frame);
    }
  result = sums;
}

QuadricMoments totals(const LaneSums& lanes)
{
  LaneSums sums = lanes;
  for (std::size_t half = LANES / 2; half > 0; half /= 2)
    for (auto& sum : sums)
      for (std::size_t l = 0; l < half; ++l)
        sum[l] += sum[l + half];
  std::array<double, NUM_SUMS> result;
  for (std::size_t k = 0; k < NUM_SUMS; ++k)
    result[k] = static_cast<double>(sums[k][0]);
  return QuadricMoments(result);
}

/// Solves m x = b for a symmetric positive definite m, of which the lower half is used, by L D L^T.
/// \return whether each pivot is at least min_pivot
bool solve(double (&m)[ORDER][ORDER], double (&b)[ORDER], double min_pivot)
{
  for (std::size_t j = 0; j < ORDER; ++j)
  {
    if (!(m[j][j] >= min_pivot))
      return false;
    for (std::size_t i = j + 1; i < ORDER; ++i)
    {
      const double factor = m[i][j] / m[j][j];
      for (std::size_t k = j + 1; k <= i; ++k)
        m[i][k] -= factor * m[k][j];
      b[i] -= factor * b[j];
    }
  }
  for (std::size_t j = ORDER; j-- > 0;)
  {
    for (std::size_t i = j + 1; i < ORDER; ++i)
      b[j] -= m[i][j] * b[i];
    b[j] /= m[j][j];
  }
  return true;
}
}  // namespace

double QuadricMoments::meanCurvature() const
{
  const auto& s = sums_;
  double m[ORDER][ORDER] = {{s[X4]},
                            {s[X3Y], s[X2Y2]},
                            {s[X2Y2], s[XY3], s[Y4]},
                            {s[X3], s[X2Y], s[XY2], s[X2]},
                            {s[X2Y], s[XY2], s[Y3], s[XY], s[Y2]},
                            {s[X2], s[XY], s[Y2], s[X], s[Y], s[N]}};
  double q[ORDER] = {s[ZX2], s[ZXY], s[ZY2], s[ZX], s[ZY], s[Z]};
  if (!solve(m, q, MIN_PIVOT * count()))
    return std::numeric_limits<double>::quiet_NaN();
  return quadricCurvature(q[0], q[1], q[2], q[3], q[4]).mean;
}

Eigen::Matrix3f tangentFrame(const Eigen::Vector3f& normal, double radius)
{
  Eigen::Matrix3f frame;
  frame.row(0) = normal.unitOrthogonal();
  frame.row(1) = normal.cross(normal.unitOrthogonal());
  frame.row(2) = normal;
  return frame / static_cast<float>(radius);
}

QuadricMoments quadricMoments(const Neighbourhood& found, const Eigen::Matrix3f& frame, const Eigen::Vector3f& normal,
                              float min_cosine)
{
  const Eigen::Matrix<float, 3, 3, Eigen::RowMajor> rows = frame;
  LaneSums sums;
  sumMoments(found, rows.data(), normal.data(), min_cosine, sums);
  return totals(sums);
}

void QuadricSums::add(const PointPlanes& planes, std::size_t begin, std::size_t end, const QuadricQuery& query)
{
  sumMomentsWithin(planes, begin, end, query.point.data(), query.normal.data(), query.frame.data(),
                   query.radius * query.radius, query.min_cosine, sums_);
}

QuadricMoments QuadricSums::moments() const { return totals(sums_); }
}  // namespace bin_picking
