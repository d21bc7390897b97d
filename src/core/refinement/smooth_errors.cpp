// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "../common/simd.hpp"
#include "field_rows.hpp"

namespace bin_picking
{
namespace
{
// Precisions (one over the variance) beside that of a measured point, whose own, independent errors are some hundredths
// of a millimetre. The smooth error is some times that; what no point holds (a tube along its axis) stays as it was.
constexpr double NODE_PRECISION = 0.15;
constexpr double STEP_PRECISION = 0.01;
constexpr double LONGEST_STEP = 0.25;  // of the leaf: more is not what the errors of a sensor do

constexpr int COLUMNS = 8;  ///< six unknowns of the pose, the residual, and a zero that fills the vector register
using Numbers = std::array<double, COLUMNS>;

/// Nodes of a grid in the picture around all points, numbered along its shorter side, so that neighbours' numbers
/// differ by little.
class NodeGrid
{
public:
  NodeGrid(const OrientedPoints& measured, double spacing) : scale_(static_cast<float>(1 / spacing))
  {
    Eigen::Array2f high = Eigen::Array2f::Constant(-std::numeric_limits<float>::infinity());
    low_ = -high;
    for (const Eigen::Vector3f& p : measured.points)
    {
      low_ = low_.min(place(p));
      high = high.max(place(p));
    }
    is_coarse_ = (high - low_ + 2).prod() < static_cast<float>(measured.size());
    if (!is_coarse_)
      return;
    const Eigen::Array2i cells = (high - low_).cast<int>() + 1;
    along_ = cells.x() < cells.y() ? 0 : 1;
    short_side_ = cells.minCoeff() + 1;
    count_ = short_side_ * (cells.maxCoeff() + 1);
  }

  /// There are more points than nodes: less tells nothing of the pose, and would take long.
  bool isCoarse() const { return is_coarse_; }
  int count() const { return count_; }
  int shortSide() const { return short_side_; }

  /// The four nodes around a point with their shares.
  struct Share
  {
    std::array<int, 4> node;
    std::array<double, 4> share;
  };
  Share at(const Eigen::Vector3f& point) const
  {
    const Eigen::Array2f q = place(point) - low_;
    const Eigen::Array2i i = q.cast<int>();
    const double a = static_cast<double>(q[along_] - static_cast<float>(i[along_]));
    const double b = static_cast<double>(q[1 - along_] - static_cast<float>(i[1 - along_]));
    const int first = i[1 - along_] * short_side_ + i[along_];
    return {{first, first + 1, first + short_side_, first + short_side_ + 1},
            {(1 - b) * (1 - a), (1 - b) * a, b * (1 - a), b * a}};
  }

private:
  Eigen::Array2f place(const Eigen::Vector3f& p) const { return p.head<2>().array() * (scale_ / p.z()); }

  float scale_;
  Eigen::Array2f low_;
  bool is_coarse_ = false;
  int along_ = 0;  ///< coordinate that runs along the shorter side
  int short_side_ = 0;
  int count_ = 0;
};

/// target[k] -= factor * source[k]
inline void subtract(double* __restrict target, const double* __restrict source, double factor, int count)
{
  for (int k = 0; k < count; ++k)
    target[k] -= factor * source[k];
}

/// Cholesky, with the couplings as further columns; what is left of `pose` is the Schur complement.
/// \param band upper half of the nodes' matrix, rows of `reach` \param reach more than numbers of nodes that share a
/// point differ
BIN_PICKING_SIMD void eliminateNodes(double* band, int reach, Numbers* coupling, int count, Numbers* pose)
{
  for (int node = 0; node < count; ++node)
  {
    const double* row = band + static_cast<std::ptrdiff_t>(node) * reach;
    const double inverse = 1 / row[0];
    for (int k = 1; k < std::min(reach, count - node); ++k)
    {
      if (row[k] == 0)
        continue;
      const double factor = row[k] * inverse;
      subtract(band + static_cast<std::ptrdiff_t>(node + k) * reach, row + k, factor, reach - k);
      subtract(coupling[node + k].data(), coupling[node].data(), factor, COLUMNS);
    }
    for (int i = 0; i < COLUMNS; ++i)
      subtract(pose[i].data(), coupling[node].data(), coupling[node][static_cast<std::size_t>(i)] * inverse, COLUMNS);
  }
}

/// The normal equations of node values and pose, of which the former are eliminated.
class NodeEquations
{
public:
  explicit NodeEquations(const NodeGrid& grid)
      : reach_(grid.shortSide() + 2),
        count_(grid.count()),
        band_(static_cast<std::size_t>(count_ * reach_), 0.0),
        coupling_(static_cast<std::size_t>(count_), Numbers{})
  {
    for (int node = 0; node < count_; ++node)
      at(node, node) = NODE_PRECISION;
  }

  /// A point whose residual has a share of four nodes.
  void add(const NodeGrid::Share& nodes, const Numbers& row, double weight)
  {
    for (std::size_t i = 0; i < 4; ++i)
    {
      const double share = weight * nodes.share[i];
      for (std::size_t j = i; j < 4; ++j)
        at(nodes.node[i], nodes.node[j]) += share * nodes.share[j];
      Numbers& coupling = coupling_[static_cast<std::size_t>(nodes.node[i])];
      for (std::size_t k = 0; k < COLUMNS; ++k)
        coupling[k] += share * row[k];
    }
  }

  /// Of all points, whatever their nodes.
  void add(const RowSums& sums)
  {
    for (std::size_t i = 0; i < RowSums::COLUMNS; ++i)
      for (std::size_t j = 0; j < RowSums::COLUMNS; ++j)
        pose_[i][j] += sums.product(std::min(i, j), std::max(i, j));
  }

  /// The most likely step of the pose, whatever the node values.
  Vector6d solve()
  {
    eliminateNodes(band_.data(), reach_, coupling_.data(), count_, pose_.data());
    Matrix6d A;
    Vector6d b;
    for (std::size_t i = 0; i < 6; ++i)
    {
      for (std::size_t j = 0; j < 6; ++j)
        A(static_cast<int>(i), static_cast<int>(j)) = pose_[i][j];
      b[static_cast<int>(i)] = -pose_[i][6];
    }
    A.diagonal().array() += STEP_PRECISION;
    return A.ldlt().solve(b);
  }

private:
  /// \pre first <= second < first + reach_
  double& at(int first, int second) { return band_[static_cast<std::size_t>(first * reach_ + second - first)]; }

  int reach_;  ///< numbers of nodes that share a point differ by less
  int count_;
  std::vector<double> band_;  ///< upper half, rows of reach_
  std::vector<Numbers> coupling_;
  std::array<Numbers, COLUMNS> pose_ = {};
};

Numbers numbersOf(const FieldRowBlock& rows, std::size_t k)
{
  Numbers numbers = {};
  for (std::size_t i = 0; i < FieldRowBlock::COLUMNS; ++i)
    numbers[i] = static_cast<double>(rows.columns[i][k]);
  return numbers;
}

/// \param points of the block
BIN_PICKING_SIMD void addBlock(const FieldRowBlock& rows, const Eigen::Vector3f* points, const NodeGrid& grid,
                               NodeEquations& equations)
{
  for (std::size_t k = 0; k < FieldRowBlock::SIZE; ++k)
    if (rows.weight[k] > 0)
      equations.add(grid.at(points[k]), numbersOf(rows, k), static_cast<double>(rows.weight[k]));
}

void addPoints(const FieldRows& rows, const OrientedPoints& surface, const NodeGrid& grid, NodeEquations& equations)
{
  FieldRowBlock block;
  RowSums sums;
  for (std::size_t first = 0; first < surface.size(); first += FieldRowBlock::SIZE)
  {
    rows.ofSurface(surface, first, block);
    addBlock(block, &surface.points[first], grid, equations);
    sums.add(block);
  }
  equations.add(sums);
}
}  // namespace

Pose fitBesideSmoothErrors(const TrainedModel& model, const OrientedPoints& surface, const Pose& refined,
                           double spacing, const IcpParameters& parameters)
{
  if (surface.empty())
    return refined;
  const Pose T_object_camera = refined.inverse();
  const double leaf = model.parameters.leaf;
  const FieldRows rows(model, T_object_camera, parameters.min_distance * leaf, parameters.max_normal_angle);
  const NodeGrid grid(surface, spacing);
  if (!grid.isCoarse())
    return refined;
  NodeEquations equations(grid);
  addPoints(rows, surface, grid, equations);
  const Vector6d step = equations.solve();
  const bool small = step.head<3>().norm() + step.tail<3>().norm() < LONGEST_STEP * leaf;
  return small ? movedBy(step, T_object_camera, model).inverse() : refined;
}
}  // namespace bin_picking
