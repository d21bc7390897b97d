// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/evaluation/evaluation_dataset.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/segmentation/segmentation.hpp"
#include "experiments.hpp"
#include "pictures.hpp"
#include "point_scene.hpp"

namespace bin_picking::paper
{
namespace
{
constexpr int HISTOGRAM_BINS = 40;
constexpr int COLORS = 24;  // steps of the curvature's colours

/// From slightly above and to the side, upright for a part whose z axis points up.
Pose lookedAt()
{
  Pose T = Pose::Identity();
  T.linear() =
      (Eigen::AngleAxisd(-0.6 * M_PI, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.6, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  return T;
}

std::pair<double, double> rangeOf(std::vector<float> values)
{
  values.erase(std::remove_if(values.begin(), values.end(), [](float q) { return std::isnan(q); }), values.end());
  if (values.empty())
    throw ParameterError("The model has no curvature; choose a feature with curvature for this figure.");
  std::sort(values.begin(), values.end());
  const auto at = [&](double share) {
    return static_cast<double>(values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))]);
  };
  return {at(0.01), at(0.99)};
}

Json histogramOf(const std::vector<float>& curvature, double low, double high)
{
  std::vector<int> counts(HISTOGRAM_BINS, 0);
  for (const float q : curvature)
  {
    if (std::isnan(q))
      continue;
    const double level = (static_cast<double>(q) - low) / std::max(1e-12, high - low);
    const int bin = static_cast<int>(std::floor(level * HISTOGRAM_BINS));
    ++counts[static_cast<std::size_t>(std::clamp(bin, 0, HISTOGRAM_BINS - 1))];
  }
  return counts;
}

void drawCurvature(const TrainedModel& model, const Pose& T_camera_object, double low, double high,
                   const std::string& file)
{
  std::vector<std::vector<int>> members(COLORS);
  for (std::size_t i = 0; i < model.points.size(); ++i)
  {
    const auto q = static_cast<double>(model.points.curvature[i]);
    const double level = std::isnan(q) ? 0 : std::clamp((q - low) / std::max(1e-12, high - low), 0.0, 0.999);
    members[static_cast<std::size_t>(level * COLORS)].push_back(static_cast<int>(i));
  }
  std::vector<ColoredCloud> clouds;
  for (int k = 0; k < COLORS; ++k)
    if (const auto& indices = members[static_cast<std::size_t>(k)]; !indices.empty())
      clouds.push_back({transformed(select(model.points, indices), T_camera_object), heat((k + 0.5) / COLORS)});
  saveCloudPicture(clouds, file);
}

/// The part alone, from the trained view that shows most of it.
DepthGrid oneSidedView(const TrainedModel& model)
{
  const auto widest = std::max_element(model.views.begin(), model.views.end(),
                                       [](const auto& a, const auto& b) { return a.area < b.area; });
  const Eigen::Vector3d forward = -widest->direction.cast<double>();
  const Eigen::Vector3d right = forward.unitOrthogonal();
  Pose T = Pose::Identity();
  T.linear().row(0) = right.transpose();
  T.linear().row(1) = forward.cross(right).transpose();
  T.linear().row(2) = forward.transpose();
  T.translation() = Eigen::Vector3d(0, 0, 8 * model.diameter) - T.linear() * model.center;
  constexpr int PIXELS = 260;
  const double focal = PIXELS * 7.0;
  DepthRenderer renderer(PIXELS, PIXELS, {focal, focal, PIXELS / 2.0, PIXELS / 2.0});
  if (model.mesh.empty())
    renderer.draw(model.surface, T, model.parameters.surface_spacing, 0);
  else
    renderer.draw(model.mesh, T, 0);
  return renderer.grid();
}

std::vector<bool> chosen(const SegmentationView& view)
{
  std::vector<bool> keep(view.candidates.size());
  for (std::size_t i = 0; i < keep.size(); ++i)
    keep[i] = view.candidates[i] > 0;
  return keep;
}
}  // namespace

Json runCurvature(const Json& specification, const std::string& folder)
{
  const PointObject object = readObject(specification.at("object"), folder);
  const Method method = readMethod(specification.at("method"));
  const Executor executor(0);
  Models models(executor, specification.value("models", ""));
  const auto model = models.get(object.part, method);
  const auto [low, high] = rangeOf(model->points.curvature);
  // The public models' y points down and their faces look at the viewer, as it is.
  drawCurvature(*model, model->mesh.empty() ? Pose::Identity() : lookedAt(), low, high,
                specification.at("picture").get<std::string>());
  Json result = describe(*model);
  result["from"] = low;
  result["to"] = high;
  result["counts"] = histogramOf(model->points.curvature, low, high);
  result["low_max"] = model->classes.low_max;
  result["high_min"] = model->classes.high_min;
  return result;
}

Json runSegmentation(const Json& specification, const std::string&)
{
  DatasetSelection selection;
  selection.parts = {specification.at("part").get<std::string>()};
  const EvaluationDataset dataset = openDataset(specification.at("dataset").get<std::string>(), selection);
  const EvaluationScene& scene = dataset.scenes.at(specification.value("scene", std::size_t{0}));
  const Method method = readMethod(specification.at("method"));
  const Executor executor(0);
  Models models(executor, specification.value("models", ""));
  const auto model = models.get(dataset.parts.front().definition, method);
  const DepthGrid grid = loadSceneGrid(scene, method.detector.input);
  Detector::Request request;
  request.bin = scene.bin;
  request.keep_segmentation = true;
  const DetectionResult result = Detector({model}, method.detector).detect(grid, request);
  const auto stem = specification.at("picture").get<std::string>();
  const DepthGrid view = oneSidedView(*model);
  saveCloudPicture({{pointsOf(view, {}), {0.9f, 0.9f, 0.9f}}}, stem + "_a.png");
  saveGray(depthToGray(view, {}, nullptr), view.width, view.height, stem + "_b.png");
  saveCloudPicture({{pointsOf(grid, {}), {0.9f, 0.9f, 0.9f}}}, stem + "_c.png");
  if (!result.segmentation)
    throw Error("Nothing was measured in scene " + scene.name + ", so that there is no segmentation to show.");
  const SegmentationView& segments = *result.segmentation;
  saveGray(segments.gray, segments.width, segments.height, stem + "_d.png");
  saveLabels(segments.labels, segments.width, segments.height, stem + "_e.png");
  saveLabels(segments.candidates, segments.width, segments.height, stem + "_f.png");
  const bool same_size = segments.width * segments.height == static_cast<int>(grid.size());
  const std::vector<bool> keep = chosen(segments);
  std::vector<bool> pixels(grid.size(), false);
  for (int v = 0; v < grid.height; ++v)
    for (int u = 0; u < grid.width; ++u)
    {
      const int x = same_size ? u : std::min(u * segments.width / grid.width, segments.width - 1);
      const int y = same_size ? v : std::min(v * segments.height / grid.height, segments.height - 1);
      pixels[static_cast<std::size_t>(grid.index(u, v))] = keep[static_cast<std::size_t>(y * segments.width + x)];
    }
  if (std::count(pixels.begin(), pixels.end(), true) > 0)
    saveCloudPicture({{pointsOf(grid, pixels), {0.9f, 0.9f, 0.9f}}}, stem + "_g.png");
  return {
      {"segments", countOf(result, "segments")}, {"candidates", countOf(result, "candidates")}, {"scene", scene.name}};
}
}  // namespace bin_picking::paper
