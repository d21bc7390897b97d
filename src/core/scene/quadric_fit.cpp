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

BIN_PICKING_SIMD void sumMoments(const Neighbourhood& found, const float* given_frame, const float* given_normal,
                                 float min_cosine, std::array<double, NUM_SUMS>& result)
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
      const float px = weight * found.x[i];
      const float py = weight * found.y[i];
      const float pz = weight * found.z[i];
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
  for (std::size_t half = LANES / 2; half > 0; half /= 2)
    for (auto& lanes : sums)
      for (std::size_t l = 0; l < half; ++l)
        lanes[l] += lanes[l + half];
  for (std::size_t k = 0; k < NUM_SUMS; ++k)
    result[k] = static_cast<double>(sums[k][0]);
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
  std::array<double, NUM_SUMS> sums;
  sumMoments(found, rows.data(), normal.data(), min_cosine, sums);
  return QuadricMoments(sums);
}
}  // namespace bin_picking
