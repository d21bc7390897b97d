// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/part_shape.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "../model/even_directions.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/model/trained_model.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t MAX_CORNERS = 1000;
constexpr int EXTREME_DIRECTIONS = 2000;
constexpr double SURFACE_POINTS = 2000;
constexpr std::uint32_t SURFACE_SEED = 1;

/// All corners of simple meshes; else the farthest in many directions: of a ball it is cut off by 0.1 % of its radius.
std::vector<Eigen::Vector3f> extremePoints(const TriangleMesh& mesh)
{
  std::set<std::uint32_t> corners;
  for (const auto& triangle : mesh.triangles)
    corners.insert(triangle.begin(), triangle.end());
  if (corners.size() > MAX_CORNERS)
  {
    std::set<std::uint32_t> farthest;
    for (const Eigen::Vector3d& direction : evenDirections(EXTREME_DIRECTIONS))
    {
      const Eigen::Vector3f d = direction.cast<float>();
      farthest.insert(*std::max_element(corners.begin(), corners.end(), [&](std::uint32_t a, std::uint32_t b) {
        return d.dot(mesh.vertices[a]) < d.dot(mesh.vertices[b]);
      }));
    }
    corners = std::move(farthest);
  }
  std::vector<Eigen::Vector3f> points;
  points.reserve(corners.size());
  for (const std::uint32_t corner : corners)
    points.push_back(mesh.vertices[corner]);
  return points;
}

/// Counts the pixels of the silhouette, and which of them are visible and measured.
void measureVisibility(TrueInstance& instance, const DepthRenderer& silhouette, const DepthGrid& grid, double tolerance)
{
  int pixels = 0;
  int visible = 0;
  int valid = 0;
  for (std::size_t i = 0; i < grid.size(); ++i)
  {
    if (silhouette.labels()[i] < 0)
      continue;
    ++pixels;
    const bool is_measured = !std::isnan(grid.z[i]);
    const bool is_hidden = is_measured && static_cast<double>(silhouette.depth()[i] - grid.z[i]) > tolerance;
    visible += !is_hidden;
    valid += is_measured && !is_hidden;
  }
  instance.visible_fraction = pixels > 0 ? static_cast<double>(visible) / pixels : 0;
  instance.visible_pixels = visible;
  instance.valid_pixels = valid;
}
}  // namespace

PartShape makePartShape(const TriangleMesh& mesh, const Symmetry& symmetry, double diameter)
{
  if (mesh.empty())
    throw ParameterError("A part without triangles has no shape to compare poses with; give it a mesh.");
  PartShape shape;
  shape.mesh = mesh;
  shape.symmetry = symmetry;
  shape.extreme_points = extremePoints(mesh);
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& point : shape.extreme_points)
    box.extend(point);
  shape.center = box.center().cast<double>();
  shape.diameter = diameter > 0 ? diameter : largestDistance(shape.extreme_points);
  const double spacing = std::sqrt(inspectMesh(mesh).area / SURFACE_POINTS);
  shape.surface_points = sampleSurface(mesh, spacing, SURFACE_SEED).points;
  return shape;
}

PartShapes loadPartShapes(const EvaluationDataset& dataset, const Executor& executor)
{
  PartShapes shapes;
  for (const EvaluationPart& part : dataset.parts)
  {
    const TriangleMesh mesh = loadMesh(part.definition.mesh_file, part.definition.mesh_unit);
    shapes.emplace(part.definition.name, makePartShape(mesh, symmetryOf(part.definition, executor), part.diameter));
  }
  return shapes;
}

void estimateVisibility(EvaluationScene& scene, const DepthGrid& grid, const PartShapes& shapes, double tolerance)
{
  for (TrueInstance& instance : scene.instances)
  {
    if (!std::isnan(instance.visible_fraction))
      continue;
    DepthRenderer silhouette(grid.width, grid.height, grid.camera);
    silhouette.draw(shapes.at(instance.part).mesh, instance.T_camera_object, 0);
    measureVisibility(instance, silhouette, grid, tolerance);
  }
}
}  // namespace bin_picking
