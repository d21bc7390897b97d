// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "field_rows.hpp"

#include <numeric>

#include "../common/simd.hpp"
#include "moved_points.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t BLOCK = FieldRowBlock::SIZE;

/// What rows are made with.
struct Rule
{
  std::array<float, 3> middle;
  float inverse_radius;
  float gate;
  float min_cosine;
};

/// \param normals one after the other, of `count`
BIN_PICKING_SIMD void makeRows(const DistanceField::Places& points, const DistanceField::Samples& samples,
                               const float* normals, std::size_t count, const Motion& motion, const Rule& given,
                               FieldRowBlock& rows)
{
  const std::array<float, 9> r = motion.rotation;
  const Rule rule = given;
  for (std::size_t k = 0; k < count; ++k)
  {
    const float gx = samples.gradient_x[k];
    const float gy = samples.gradient_y[k];
    const float gz = samples.gradient_z[k];
    const float lx = (points.x[k] - rule.middle[0]) * rule.inverse_radius;
    const float ly = (points.y[k] - rule.middle[1]) * rule.inverse_radius;
    const float lz = (points.z[k] - rule.middle[2]) * rule.inverse_radius;
    rows.columns[0][k] = ly * gz - lz * gy;
    rows.columns[1][k] = lz * gx - lx * gz;
    rows.columns[2][k] = lx * gy - ly * gx;
    rows.columns[3][k] = gx;
    rows.columns[4][k] = gy;
    rows.columns[5][k] = gz;
    rows.columns[6][k] = samples.distance[k];
    const float nx = normals[3 * k];
    const float ny = normals[3 * k + 1];
    const float nz = normals[3 * k + 2];
    const float along = (r[0] * nx + r[1] * ny + r[2] * nz) * gx + (r[3] * nx + r[4] * ny + r[5] * nz) * gy +
                        (r[6] * nx + r[7] * ny + r[8] * nz) * gz;
    const float share = samples.distance[k] / rule.gate;
    const float root = 1 - share * share;
    const bool counts = (root > 0) & (along > rule.min_cosine * std::sqrt(gx * gx + gy * gy + gz * gz));
    rows.weight[k] = counts ? root * root : 0;
  }
}

using Lanes = std::array<double, RowSums::LANES>;

/// sum += weight * a * b, lane by lane: the order of the sums is the same for every processor.
BIN_PICKING_INLINE void addProducts(const DistanceField::Numbers& weighted, const DistanceField::Numbers& b, Lanes& sum)
{
  constexpr std::size_t LANES = RowSums::LANES;
  std::array<float, LANES> part = {};
  for (std::size_t first = 0; first < BLOCK; first += LANES)
    for (std::size_t lane = 0; lane < LANES; ++lane)
      part[lane] += weighted[first + lane] * b[first + lane];
  for (std::size_t lane = 0; lane < LANES; ++lane)
    sum[lane] += static_cast<double>(part[lane]);
}

BIN_PICKING_SIMD void addRows(const FieldRowBlock& rows, std::array<Lanes, RowSums::PAIRS + 1>& sums)
{
  DistanceField::Numbers one;
  one.fill(1);
  DistanceField::Numbers weighted;
  Lanes* sum = sums.data();
  for (std::size_t i = 0; i < FieldRowBlock::COLUMNS; ++i)
  {
    for (std::size_t k = 0; k < BLOCK; ++k)
      weighted[k] = rows.weight[k] * rows.columns[i][k];
    for (std::size_t j = i; j < FieldRowBlock::COLUMNS; ++j)
      addProducts(weighted, rows.columns[j], *sum++);
  }
  addProducts(rows.weight, one, *sum);
}
}  // namespace

void FieldRows::ofSurface(const OrientedPoints& surface, std::size_t first, FieldRowBlock& rows) const
{
  const std::size_t count = std::min(BLOCK, surface.size() - first);
  const Motion motion(T_object_camera_);
  DistanceField::Places places;
  movePoints(surface.points[first].data(), count, motion, places);
  DistanceField::Samples samples;
  field_.sample(places, samples);
  const Rule rule = {{middle_.x(), middle_.y(), middle_.z()}, inverse_radius_, gate_, min_cosine_};
  makeRows(places, samples, surface.normals[first].data(), count, motion, rule, rows);
  for (std::size_t k = count; k < BLOCK; ++k)
  {
    for (DistanceField::Numbers& column : rows.columns)
      column[k] = 0;
    rows.weight[k] = 0;
  }
}

void RowSums::add(const FieldRowBlock& rows)
{
  addRows(rows, sums_);
  count_ +=
      static_cast<int>(std::count_if(rows.weight.begin(), rows.weight.end(), [](float weight) { return weight > 0; }));
}

void RowSums::add(const FieldRow& row)
{
  const Eigen::Vector3f turn = row.lever.cross(row.gradient);
  const Eigen::Vector3f& push = row.gradient;
  const std::array<float, COLUMNS> columns = {turn.x(), turn.y(), turn.z(), push.x(), push.y(), push.z(), row.residual};
  std::size_t pair = 0;
  for (std::size_t i = 0; i < COLUMNS; ++i)
    for (std::size_t j = i; j < COLUMNS; ++j, ++pair)
      sums_[pair][0] += static_cast<double>(row.weight * columns[i] * columns[j]);
  sums_[PAIRS][0] += static_cast<double>(row.weight);
  ++count_;
}

double RowSums::total(std::size_t k) const { return std::accumulate(sums_[k].begin(), sums_[k].end(), 0.0); }

Pose movedBy(const Vector6d& x, const Pose& T_object_camera, const TrainedModel& model)
{
  const Eigen::Vector3d rotation = x.head<3>() / FieldRows::radius(model);
  const double angle = rotation.norm();
  Pose step = Pose::Identity();
  if (angle > 0)
    step.linear() = Eigen::AngleAxisd(angle, rotation / angle).toRotationMatrix();
  step.translation() = model.center - step.linear() * model.center + x.tail<3>();
  Pose T = step * T_object_camera;
  // Products of rotations drift; the nearest rotation keeps the pose rigid.
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return T;
}
}  // namespace bin_picking
