// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "pair_quantizer.hpp"

#include <algorithm>
#include <cmath>

#include "../common/simd.hpp"

namespace bin_picking
{
FlatPoints::FlatPoints(const OrientedPoints& points, const std::vector<int>& order)
{
  for (auto* values : {&x, &y, &z, &nx, &ny, &nz})
    values->reserve(order.size());
  for (const int i : order)
  {
    const Eigen::Vector3f& p = points.points[static_cast<std::size_t>(i)];
    const Eigen::Vector3f& n = points.normals[static_cast<std::size_t>(i)];
    x.push_back(p.x());
    y.push_back(p.y());
    z.push_back(p.z());
    nx.push_back(n.x());
    ny.push_back(n.y());
    nz.push_back(n.z());
  }
}

PairOrigin::PairOrigin(const Eigen::Vector3f& p, const Eigen::Vector3f& n) : point(p), normal(n)
{
  const Eigen::Matrix3f R_local_camera = alignToLocalFrame(p, n).linear();
  to_y = R_local_camera.row(1);
  to_z = R_local_camera.row(2);
}

PairQuantizer::PairQuantizer(const FeatureQuantizer& quantizer, double min_distance, double reach)
    : squared_min_(static_cast<float>(std::max(min_distance * min_distance, 1e-12))),
      squared_max_(static_cast<float>(reach * reach)),
      inverse_distance_step_(static_cast<float>(1 / quantizer.distance_step)),
      inverse_angle_step_(static_cast<float>(1 / quantizer.angle_step)),
      distance_bins_(quantizer.distance_bins),
      angle_bins_(quantizer.angle_bins),
      no_key_(quantizer.numGeometricKeys())
{}

namespace
{
/// acos to 1e-6 rad (Abramowitz and Stegun, 4.4.46).
inline float fastAcos(float cosine)
{
  const float x = std::min(std::abs(cosine), 1.0f);
  float p = -0.0012624911f;
  p = p * x + 0.0066700901f;
  p = p * x - 0.0170881256f;
  p = p * x + 0.0308918810f;
  p = p * x - 0.0501743046f;
  p = p * x + 0.0889789874f;
  p = p * x - 0.2145988016f;
  p = p * x + 1.5707963050f;
  const float angle = p * std::sqrt(1 - x);
  return cosine < 0 ? static_cast<float>(M_PI) - angle : angle;
}

/// atan2(y, x) in turns, to 0.005 degrees: octant by octant atan(q) / 2 pi by an odd polynomial (minimax fit).
inline float fastTurn(float y, float x)
{
  const float ax = std::abs(x);
  const float ay = std::abs(y);
  const float q = std::min(ax, ay) / std::max(std::max(ax, ay), 1e-30f);
  const float s = q * q;
  float turn = q * (0.15902992f + s * (-0.051117657f + s * (0.023281341f + s * -0.0062066667f)));
  turn = ay > ax ? 0.25f - turn : turn;
  turn = x < 0 ? 0.5f - turn : turn;
  return y < 0 ? 1 - turn : turn;
}

/// What the loop needs, by value: the compiler then knows that nothing it writes changes it.
struct Constants
{
  float px, py, pz, nx, ny, nz, yx, yy, yz, zx, zy, zz;
  float squared_min, squared_max, inverse_distance_step, inverse_angle_step;
  std::int32_t distance_bins, angle_bins;
  std::uint32_t no_key;
};

BIN_PICKING_SIMD void quantizePairs(const Constants c, const float* __restrict x, const float* __restrict y,
                                    const float* __restrict z, const float* __restrict nx, const float* __restrict ny,
                                    const float* __restrict nz, std::size_t count, std::uint32_t* __restrict keys,
                                    std::uint16_t* __restrict alphas)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    const float dx = x[i] - c.px;
    const float dy = y[i] - c.py;
    const float dz = z[i] - c.pz;
    const float squared = dx * dx + dy * dy + dz * dz;
    const float distance = std::sqrt(squared);
    const float inverse = 1 / std::max(distance, 1e-12f);
    const float cosine_1 = (c.nx * dx + c.ny * dy + c.nz * dz) * inverse;
    const float cosine_2 = (nx[i] * dx + ny[i] * dy + nz[i] * dz) * inverse;
    const float cosine_12 = c.nx * nx[i] + c.ny * ny[i] + c.nz * nz[i];
    // A pair that is too far apart may overflow the key, which is then thrown away.
    const auto bin = static_cast<std::int32_t>(std::min(distance, 1e3f) * c.inverse_distance_step);
    const auto bin_1 = std::min(static_cast<std::int32_t>(fastAcos(cosine_1) * c.inverse_angle_step), c.angle_bins - 1);
    const auto bin_2 = std::min(static_cast<std::int32_t>(fastAcos(cosine_2) * c.inverse_angle_step), c.angle_bins - 1);
    const auto bin_12 =
        std::min(static_cast<std::int32_t>(fastAcos(cosine_12) * c.inverse_angle_step), c.angle_bins - 1);
    const auto angles = static_cast<std::uint32_t>(c.angle_bins);
    const std::uint32_t key = ((static_cast<std::uint32_t>(bin) * angles + static_cast<std::uint32_t>(bin_1)) * angles +
                               static_cast<std::uint32_t>(bin_2)) *
                                  angles +
                              static_cast<std::uint32_t>(bin_12);
    const bool stored = (squared >= c.squared_min) & (squared <= c.squared_max) & (bin < c.distance_bins);
    keys[i] = stored ? key : c.no_key;
    // alphaInLocalFrame
    const float turn = fastTurn(-(c.zx * dx + c.zy * dy + c.zz * dz), c.yx * dx + c.yy * dy + c.yz * dz);
    // A share of a turn, never negative, so that this rounds right; lround would end the vector code.
    alphas[i] = static_cast<std::uint16_t>(
        static_cast<std::int32_t>(turn * 65536 + 0.5f));  // NOLINT(bugprone-incorrect-roundings)
  }
}
}  // namespace

void PairQuantizer::quantize(const PairOrigin& origin, const FlatPoints& points, std::size_t begin, std::size_t end,
                             std::uint32_t* keys, std::uint16_t* alphas) const
{
  const Constants constants{origin.point.x(),
                            origin.point.y(),
                            origin.point.z(),
                            origin.normal.x(),
                            origin.normal.y(),
                            origin.normal.z(),
                            origin.to_y.x(),
                            origin.to_y.y(),
                            origin.to_y.z(),
                            origin.to_z.x(),
                            origin.to_z.y(),
                            origin.to_z.z(),
                            squared_min_,
                            squared_max_,
                            inverse_distance_step_,
                            inverse_angle_step_,
                            distance_bins_,
                            angle_bins_,
                            no_key_};
  quantizePairs(constants, &points.x[begin], &points.y[begin], &points.z[begin], &points.nx[begin], &points.ny[begin],
                &points.nz[begin], end - begin, keys, alphas);
}
}  // namespace bin_picking
