// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "part_views.hpp"

#include <cmath>

#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/scene/edge_points.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"
#include "even_directions.hpp"
#include "view_camera.hpp"

namespace bin_picking
{
namespace
{
constexpr int NUM_VIEWS = 64;
constexpr double PIXELS_PER_LEAF = 3;  // as in the scene's working grid
constexpr double MIN_FACING_COSINE = 0.3;
constexpr float MAX_DEPTH_PIXELS = 2;  // of a model point, a mean of its voxel, from the surface in its pixel

/// A view on its way: what is computed once for points and edges.
struct Rendered
{
  Pose T_camera_object;
  DepthGrid grid;
  ConnectedRuns runs;
  std::vector<Eigen::Vector3f> normals;
};

Rendered render(const TrainedModel& model, const ViewCamera& camera, const Eigen::Vector3d& direction,
                const Executor& executor)
{
  Rendered view;
  view.T_camera_object = camera.poseOfObject(direction);
  DepthRenderer image(camera.side, camera.side, camera.intrinsics);
  image.draw(model.mesh, view.T_camera_object, 0);
  view.grid = image.grid();
  view.runs = connectedRuns(view.grid, EdgeRule(), executor);
  view.normals = estimateGridNormals(view.grid, view.runs, model.parameters.normal_radius, executor);
  return view;
}

/// The model points that the view sees, measured as scene samples are.
void measurePoints(const TrainedModel& model, const ViewCamera& camera, const Rendered& rendered,
                   const Executor& executor, PartView& view)
{
  const TrainingParameters& p = model.parameters;
  for (std::size_t i = 0; i < model.points.size(); ++i)
  {
    const Eigen::Vector3d point = rendered.T_camera_object * model.points.points[i].cast<double>();
    const Eigen::Vector3d normal = rendered.T_camera_object.linear() * model.points.normals[i].cast<double>();
    if (!(-normal.dot(point.normalized()) > MIN_FACING_COSINE))
      continue;
    const Eigen::Vector2d uv = camera.intrinsics.project(point);
    const int pixel = rendered.grid.index(static_cast<int>(std::lround(uv.x())), static_cast<int>(std::lround(uv.y())));
    const auto k = static_cast<std::size_t>(pixel);
    const float off = std::abs(rendered.grid.z[k] - static_cast<float>(point.z()));
    if (!(off < MAX_DEPTH_PIXELS * static_cast<float>(camera.pixel)) || std::isnan(rendered.normals[k].x()))
      continue;
    view.points.push_back(i);
    view.samples.points.push_back(point.cast<float>());
    view.samples.normals.push_back(rendered.normals[k]);
    view.samples.pixel.push_back(pixel);
  }
  if (p.curvature_in_views)
    estimateGridCurvature(view.samples, rendered.grid, rendered.runs, rendered.normals, p.curvature_measure,
                          p.curvature_radius, OPPOSITE_WALL_ANGLE, executor);
}

/// The edges of the faces, as if a floor lay far behind the part.
OrientedPoints measureEdges(const TrainedModel& model, const ViewCamera& camera, const Rendered& rendered,
                            const Executor& executor)
{
  DepthGrid surroundings = rendered.grid;
  const auto floor = static_cast<float>(camera.distance + 2 * model.diameter);
  for (float& z : surroundings.z)
    z = std::isnan(z) ? floor : z;
  const double min_drop = MIN_EDGE_DROP * model.parameters.leaf;
  const DepthEdges edges = findDepthEdges(rendered.grid, surroundings, rendered.runs, min_drop, executor);
  return transformed(edgePoints(rendered.grid, rendered.normals, edges), rendered.T_camera_object.inverse());
}
}  // namespace

std::vector<PartView> measureViews(const TrainedModel& model, const Executor& executor)
{
  if (model.mesh.empty())
    return {};
  std::vector<Eigen::Vector3f> outline = model.mesh.vertices;
  outline.insert(outline.end(), model.points.points.begin(), model.points.points.end());
  const ViewCamera camera(outline, model.parameters.leaf / PIXELS_PER_LEAF);
  const std::vector<Eigen::Vector3d> directions = evenDirections(NUM_VIEWS);
  std::vector<PartView> views(directions.size());
  executor.forEach(directions.size(), [&](std::size_t v) {
    const Executor this_thread(1);  // the views run beside each other
    const Rendered rendered = render(model, camera, directions[v], this_thread);
    measurePoints(model, camera, rendered, this_thread, views[v]);
    if (model.parameters.edge_pairs)
      views[v].edges = measureEdges(model, camera, rendered, this_thread);
  });
  return views;
}
}  // namespace bin_picking
