// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "view_curvature.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"
#include "even_directions.hpp"
#include "view_camera.hpp"

namespace bin_picking
{
namespace
{
constexpr int NUM_VIEWS = 32;
constexpr double MIN_FACING_COSINE = 0.3;
constexpr float MAX_DEPTH_PIXELS = 2;    // of a model point, a mean of its voxel, from the surface in its pixel
constexpr double SD_OF_MEDIAN = 1.4826;  // standard deviation per median deviation of a normal distribution

/// The model points that one view sees, measured as scene samples are.
struct MeasuredView
{
  std::vector<std::size_t> points;
  SceneSamples samples;
};

MeasuredView measureView(const TrainedModel& model, const ViewCamera& camera, const Eigen::Vector3d& direction)
{
  const Executor this_thread(1);  // the views run beside each other
  const TrainingParameters& p = model.parameters;
  const Pose T_camera_object = camera.poseOfObject(direction);
  DepthRenderer image(camera.side, camera.side, camera.intrinsics);
  image.draw(model.mesh, T_camera_object, 0);
  const DepthGrid grid = image.grid();
  const ConnectedRuns runs = connectedRuns(grid, EdgeRule(), this_thread);
  const std::vector<Eigen::Vector3f> normals = estimateGridNormals(grid, runs, p.normal_radius, this_thread);
  MeasuredView view;
  for (std::size_t i = 0; i < model.points.size(); ++i)
  {
    const Eigen::Vector3d point = T_camera_object * model.points.points[i].cast<double>();
    const Eigen::Vector3d normal = T_camera_object.linear() * model.points.normals[i].cast<double>();
    if (!(-normal.dot(point.normalized()) > MIN_FACING_COSINE))
      continue;
    const Eigen::Vector2d uv = camera.intrinsics.project(point);
    const int pixel = grid.index(static_cast<int>(std::lround(uv.x())), static_cast<int>(std::lround(uv.y())));
    const auto k = static_cast<std::size_t>(pixel);
    const float off = std::abs(grid.z[k] - static_cast<float>(point.z()));
    if (!(off < MAX_DEPTH_PIXELS * static_cast<float>(camera.pixel)) || std::isnan(normals[k].x()))
      continue;
    view.points.push_back(i);
    view.samples.points.push_back(point.cast<float>());
    view.samples.normals.push_back(normals[k]);
    view.samples.pixel.push_back(pixel);
  }
  estimateGridCurvature(view.samples, grid, runs, normals, p.curvature_measure, p.curvature_radius, OPPOSITE_WALL_ANGLE,
                        this_thread);
  return view;
}

struct Values
{
  std::vector<float> complete;
  std::vector<float> cut_off;  ///< by an occlusion edge
};

float meanOf(const std::vector<float>& values)
{
  double sum = 0;
  for (const float value : values)
    sum += static_cast<double>(value);
  return values.empty() ? std::numeric_limits<float>::quiet_NaN()
                        : static_cast<float>(sum / static_cast<double>(values.size()));
}
}  // namespace

ViewCurvature curvatureInViews(const TrainedModel& model, double pixel, const Executor& executor)
{
  std::vector<Eigen::Vector3f> outline = model.mesh.vertices;
  outline.insert(outline.end(), model.points.points.begin(), model.points.points.end());
  const ViewCamera camera(outline, pixel);
  const std::vector<Eigen::Vector3d> directions = evenDirections(NUM_VIEWS);
  std::vector<MeasuredView> views(directions.size());
  executor.forEach(directions.size(), [&](std::size_t v) { views[v] = measureView(model, camera, directions[v]); });

  std::vector<Values> values(model.points.size());
  for (const MeasuredView& view : views)
    for (std::size_t k = 0; k < view.points.size(); ++k)
      if (!std::isnan(view.samples.curvature[k]))
      {
        Values& own = values[view.points[k]];
        (view.samples.curvature_complete[k] ? own.complete : own.cut_off).push_back(view.samples.curvature[k]);
      }

  ViewCurvature result;
  std::vector<float> deviations;
  for (const Values& own : values)
  {
    result.mean.push_back(meanOf(own.complete.empty() ? own.cut_off : own.complete));
    if (own.complete.size() < 2)
      continue;
    const auto n = static_cast<float>(own.complete.size());
    const float from_own_mean = std::sqrt(n / (n - 1));  // deviations from the mean of few are too small
    for (const float value : own.complete)
      deviations.push_back(from_own_mean * std::abs(value - result.mean.back()));
  }
  if (!deviations.empty())
  {
    const auto middle = deviations.begin() + static_cast<std::ptrdiff_t>(deviations.size() / 2);
    std::nth_element(deviations.begin(), middle, deviations.end());
    result.repeatability = SD_OF_MEDIAN * static_cast<double>(*middle);
  }
  return result;
}
}  // namespace bin_picking
