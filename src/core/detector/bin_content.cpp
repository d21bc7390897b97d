// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/figures.hpp"
#include "stages.hpp"

namespace bin_picking
{
namespace
{
constexpr int FLOOR_PLACES = 64;       // along each side of the floor that are looked at
constexpr double FLOOR_DEPTH = 0.010;  // metres from the floor's plane within which a measurement is the floor's

/// Of raw pixels, estimated from the working grid.
template <typename Counts>
double countPixels(const PreparedScene& scene, const Counts& counts)
{
  std::size_t pixels = 0;
  for (int i = 0; i < static_cast<int>(scene.grid.size()); ++i)
    pixels += scene.grid.valid(i) && counts(scene.grid.point(i)) ? 1 : 0;
  return static_cast<double>(pixels) * scene.reduction * scene.reduction;
}

/// Whether the place of the floor, bin frame, is measured: seen, hidden by nothing and not below where the bin is said
/// to be.
bool floorIsMeasured(const DepthGrid& grid, const Pose& T_camera_bin, const Eigen::Vector3d& place, double depth)
{
  const Eigen::Vector3d p = T_camera_bin * place;
  if (!(p.z() > 0))
    return false;
  const Eigen::Vector2d pixel = grid.camera.project(p);
  const int u = static_cast<int>(std::lround(pixel.x()));
  const int v = static_cast<int>(std::lround(pixel.y()));
  if (!grid.inside(u, v) || !grid.valid(grid.index(u, v)))
    return false;
  const Eigen::Vector3d measured = T_camera_bin.inverse() * grid.point(grid.index(u, v)).cast<double>();
  return std::abs(measured.z()) <= depth;
}

/// By area, so that it does not matter from where the camera looks. Without a bin, the share of the whole picture.
double measuredFloor(const PreparedScene& scene, const InputParameters& parameters)
{
  const DepthGrid& grid = scene.surroundings;
  if (!scene.bin)
  {
    const auto valid = std::count_if(grid.z.begin(), grid.z.end(), [](float z) { return !std::isnan(z); });
    return static_cast<double>(valid) / static_cast<double>(std::max<std::size_t>(1, grid.size()));
  }
  const Eigen::Vector2d size = scene.bin->inner_size.head<2>();
  const double depth = std::max(FLOOR_DEPTH, parameters.bin_floor_margin);
  int measured = 0;
  for (int i = 0; i < FLOOR_PLACES; ++i)
    for (int k = 0; k < FLOOR_PLACES; ++k)
    {
      const Eigen::Vector3d place(size.x() * ((i + 0.5) / FLOOR_PLACES - 0.5),
                                  size.y() * ((k + 0.5) / FLOOR_PLACES - 0.5), 0);
      measured += floorIsMeasured(grid, scene.bin->T_camera_bin, place, depth) ? 1 : 0;
    }
  return measured / static_cast<double>(FLOOR_PLACES * FLOOR_PLACES);
}

std::string countText(double count) { return std::to_string(static_cast<long>(count)); }
}  // namespace

double measuredPoints(const PreparedScene& scene)
{
  return countPixels(scene, [](const Eigen::Vector3f&) { return true; });
}

void BinContent::look(const PreparedScene& scene, const InputParameters& parameters)
{
  const double measured = measuredPoints(scene);
  double off_walls = measured;
  has_bin = scene.bin.has_value();
  if (has_bin)
  {
    const Eigen::Isometry3f T_bin_camera(scene.bin->T_camera_bin.inverse().cast<float>());
    const Eigen::Array2f limit = scene.bin->inner_size.head<2>().cast<float>().array() / 2 -
                                 static_cast<float>(parameters.empty_bin_wall_margin);
    off_walls = countPixels(
        scene, [&](const Eigen::Vector3f& p) { return ((T_bin_camera * p).head<2>().array().abs() < limit).all(); });
  }
  points = std::max(points, off_walls);
  beside_walls = std::max(beside_walls, measured - off_walls);
  if (isLittle(parameters))
    floor_share = std::max(floor_share, measuredFloor(scene, parameters));
}

void BinContent::describe(const InputParameters& parameters, DetectionResult& result) const
{
  const std::string place = has_bin ? "its floor" : "the picture";
  const std::string least = percent(parameters.empty_bin_floor_share, 0) + " (input/empty_bin_floor_share)";
  const std::string share = percent(floor_share, 0) + " of " + place;
  const std::string off = " off its walls (input/empty_bin_wall_margin; nearer are " + countText(beside_walls) + ")";
  const std::string few = "about " + countText(points) + " points lie inside the limits" +
                          (has_bin ? " and " + millimetres(parameters.empty_bin_wall_margin) + off : "") +
                          ", fewer than " + std::to_string(parameters.empty_bin_points) + " (input/empty_bin_points)";
  if (floor_share >= parameters.empty_bin_floor_share)
  {
    result.code = DetectionCode::BinEmpty;
    result.message = "the bin is empty: " + few + ", and " + share + " is measured, at least " + least;
    return;
  }
  result.code = DetectionCode::BinUnseen;
  result.message = "nobody knows whether the bin is empty: " + few + ", but only " + share +
                   " is measured and at least " + least +
                   " must be to call it empty; check projector and exposure, what covers the view, and the bin's pose";
}
}  // namespace bin_picking
