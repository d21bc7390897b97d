// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/scene/curvature.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t BLOCK = 64;
constexpr double PI = 3.14159265358979323846;
constexpr double MAX_NEIGHBOURS = 150;
constexpr std::size_t MIN_QUADRIC_POINTS = 12;
constexpr std::size_t MIN_VARIATION_POINTS = 5;
/// Smallest pivot per point of the normal equations; below, the points form a strip that fixes no quadric.
constexpr double MIN_PIVOT = 1e-4;
/// Share of the area of a disc of the radius that must be measured.
constexpr double MIN_COMPLETE_AREA = 0.8;
/// A pixel on a surface seen almost from the side stands for no more than this many times its frontal area.
constexpr double MAX_FORESHORTENING = 5;

/// What was found around a sample.
struct Neighbourhood
{
  std::vector<Eigen::Vector3f> points;  ///< relative to the sample
  std::vector<Eigen::Vector3f> normals;
  double area = 0;  ///< of the connected surface within the radius, square metres
};

/// Walks over the connected pixels around a sample, every stride-th in both directions.
class NeighbourSearch
{
public:
  NeighbourSearch(const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals, const ConnectedRuns& runs,
                  double radius, double max_normal_angle)
      : grid_(grid),
        normals_(normals),
        runs_(runs),
        radius_(static_cast<float>(radius)),
        min_cosine_(static_cast<float>(std::cos(max_normal_angle)))
  {}

  void find(const Eigen::Vector3f& centre, const Eigen::Vector3f& normal, int pixel, Neighbourhood& found)
  {
    prepare(pixel);
    found.points.clear();
    found.normals.clear();
    found.area = 0;
    queue_.clear();
    visit(reach_, reach_, pixel, centre);
    for (std::size_t k = 0; k < queue_.size(); ++k)
    {
      const Cell cell = queue_[k];
      addNeighbour(cell.pixel, centre, normal, found);
      const auto i = static_cast<std::size_t>(cell.pixel);
      if (runs_.left[i] >= stride_)
        visit(cell.column - 1, cell.row, cell.pixel - stride_, centre);
      if (runs_.right[i] >= stride_)
        visit(cell.column + 1, cell.row, cell.pixel + stride_, centre);
      if (runs_.up[i] >= stride_)
        visit(cell.column, cell.row - 1, cell.pixel - stride_ * grid_.width, centre);
      if (runs_.down[i] >= stride_)
        visit(cell.column, cell.row + 1, cell.pixel + stride_ * grid_.width, centre);
    }
  }

private:
  struct Cell
  {
    int column, row, pixel;
  };

  /// Lattice around the pixel: no point within the radius lies outside of it.
  void prepare(int pixel)
  {
    const double pitch = grid_.pitch(static_cast<double>(grid_.z[static_cast<std::size_t>(pixel)]));
    const double radius_pixels = static_cast<double>(radius_) / pitch;
    stride_ = std::max(1, static_cast<int>(std::ceil(std::sqrt(PI * radius_pixels * radius_pixels / MAX_NEIGHBOURS))));
    // One more, because points nearer to the camera have a finer pitch.
    reach_ = static_cast<int>(radius_pixels / stride_) + 2;
    side_ = 2 * reach_ + 1;
    seen_.assign(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0);
  }

  void visit(int column, int row, int pixel, const Eigen::Vector3f& centre)
  {
    if (column < 0 || row < 0 || column >= side_ || row >= side_)
      return;
    std::uint8_t& seen =
        seen_[static_cast<std::size_t>(row) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(column)];
    if (seen || (grid_.point(pixel) - centre).squaredNorm() > radius_ * radius_)
      return;
    seen = 1;
    queue_.push_back({column, row, pixel});
  }

  void addNeighbour(int pixel, const Eigen::Vector3f& centre, const Eigen::Vector3f& normal, Neighbourhood& found) const
  {
    const Eigen::Vector3f point = grid_.point(pixel);
    const Eigen::Vector3f& own = normals_[static_cast<std::size_t>(pixel)];
    found.area += surfaceArea(point, std::isnan(own.x()) ? normal : own);
    if (own.dot(normal) >= min_cosine_)
    {
      found.points.push_back(point - centre);
      found.normals.push_back(own);
    }
  }

  /// Area of the plane through the point that one lattice cell covers: (z stride)^2 / (fx fy |n . ray|), ray = p / z.
  double surfaceArea(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const
  {
    const double side = grid_.pitch(static_cast<double>(point.z())) * stride_;
    const double cosine = std::abs(static_cast<double>(normal.dot(point) / point.z()));
    return side * side * std::min(MAX_FORESHORTENING, 1 / cosine);
  }

  const DepthGrid& grid_;
  const std::vector<Eigen::Vector3f>& normals_;
  const ConnectedRuns& runs_;
  float radius_;
  float min_cosine_;
  int stride_ = 1;
  int reach_ = 0;
  int side_ = 0;
  std::vector<std::uint8_t> seen_;
  std::vector<Cell> queue_;
};

/// Rows: two axes of the tangent plane and the normal.
Eigen::Matrix3f tangentFrame(const Eigen::Vector3f& normal)
{
  Eigen::Matrix3f frame;
  frame.row(0) = normal.unitOrthogonal();
  frame.row(1) = normal.cross(normal.unitOrthogonal());
  frame.row(2) = normal;
  return frame;
}

/// Sums of x^i y^j up to the fourth order and of z times the six terms of a quadric: all that its least squares fit
/// needs.
class QuadricFit
{
public:
  void add(double x, double y, double z)
  {
    const double xx = x * x;
    const double xy = x * y;
    const double yy = y * y;
    const std::array<double, 6> t = {xx, xy, yy, x, y, 1};
    for (std::size_t k = 0; k < 6; ++k)
    {
      right_[k] += z * t[k];
      second_[k] += t[k];
      third_x_[k] += xx * t[k];
      third_y_[k] += yy * t[k];
    }
  }

  /// Mean curvature at the origin; NaN if the points do not fix the quadric.
  double meanCurvature() const
  {
    using Matrix6 = Eigen::Matrix<double, 6, 6>;
    const double x2 = second_[0], xy = second_[1], y2 = second_[2], x1 = second_[3], y1 = second_[4], n = second_[5];
    const double x4 = third_x_[0], x3y = third_x_[1], x2y2 = third_x_[2], x3 = third_x_[3], x2y = third_x_[4];
    const double xy3 = third_y_[1], y4 = third_y_[2], xy2 = third_y_[3], y3 = third_y_[4];
    Matrix6 m;
    m << x4, x3y, x2y2, x3, x2y, x2,   //
        x3y, x2y2, xy3, x2y, xy2, xy,  //
        x2y2, xy3, y4, xy2, y3, y2,    //
        x3, x2y, xy2, x2, xy, x1,      //
        x2y, xy2, y3, xy, y2, y1,      //
        x2, xy, y2, x1, y1, n;
    const Eigen::LDLT<Matrix6> solver(m);
    if (!(solver.vectorD().minCoeff() >= MIN_PIVOT * n))
      return std::numeric_limits<double>::quiet_NaN();
    const Eigen::Matrix<double, 6, 1> q = solver.solve(Eigen::Map<const Eigen::Matrix<double, 6, 1>>(right_.data()));
    return quadricCurvature(q[0], q[1], q[2], q[3], q[4]).mean;
  }

private:
  std::array<double, 6> right_{};
  std::array<double, 6> second_{};
  std::array<double, 6> third_x_{};
  std::array<double, 6> third_y_{};
};

double meanCurvature(const Neighbourhood& neighbours, const Eigen::Vector3f& normal, double radius)
{
  if (neighbours.points.size() < MIN_QUADRIC_POINTS)
    return std::numeric_limits<double>::quiet_NaN();
  // In units of the radius, so that the normal equations are well scaled.
  const Eigen::Matrix3f frame = tangentFrame(normal) / static_cast<float>(radius);
  QuadricFit fit;
  for (const auto& point : neighbours.points)
  {
    const Eigen::Vector3f q = frame * point;
    fit.add(static_cast<double>(q.x()), static_cast<double>(q.y()), static_cast<double>(q.z()));
  }
  return fit.meanCurvature() / radius;
}

/// (pc1 + pc2) / 2: half the trace of the covariance of the normals projected onto the tangent plane.
double normalVariation(const Neighbourhood& neighbours, const Eigen::Vector3f& normal)
{
  if (neighbours.normals.size() < MIN_VARIATION_POINTS)
    return std::numeric_limits<double>::quiet_NaN();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double squares = 0;
  for (const auto& n : neighbours.normals)
  {
    const Eigen::Vector3d projected = (n - normal.dot(n) * normal).cast<double>();
    sum += projected;
    squares += projected.squaredNorm();
  }
  const auto count = static_cast<double>(neighbours.normals.size());
  return (squares / count - (sum / count).squaredNorm()) / 2;
}
}  // namespace

void estimateGridCurvature(SceneSamples& samples, const DepthGrid& grid, const std::vector<Eigen::Vector3f>& normals,
                           CurvatureMeasure measure, double radius, double max_normal_angle, const Executor& executor)
{
  const ConnectedRuns runs = connectedRuns(grid, EdgeRule());
  samples.curvature.assign(samples.size(), std::numeric_limits<float>::quiet_NaN());
  samples.curvature_complete.assign(samples.size(), 0);
  executor.forEach((samples.size() + BLOCK - 1) / BLOCK, [&](std::size_t block) {
    NeighbourSearch search(grid, normals, runs, radius, max_normal_angle);
    Neighbourhood found;
    for (std::size_t i = block * BLOCK; i < std::min(samples.size(), (block + 1) * BLOCK); ++i)
    {
      search.find(samples.points[i], samples.normals[i], samples.pixel[i], found);
      samples.curvature[i] = static_cast<float>(measure == CurvatureMeasure::MeanCurvature
                                                    ? meanCurvature(found, samples.normals[i], radius)
                                                    : normalVariation(found, samples.normals[i]));
      samples.curvature_complete[i] = found.area >= MIN_COMPLETE_AREA * PI * radius * radius;
    }
  });
}
}  // namespace bin_picking
