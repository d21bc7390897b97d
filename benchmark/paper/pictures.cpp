// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "pictures.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/evaluation/detection_picture.hpp"
#include "bin_picking_perception/evaluation/picture_file.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"

namespace bin_picking::paper
{
namespace
{
constexpr int SIZE = 420;                // pixels of a cloud's picture along its longer edge
constexpr double FAR_AWAY = 20;          // of the clouds' size: nearly parallel rays
const cv::Vec3b BACKGROUND(46, 36, 30);  // blue, green, red
const Eigen::Vector3f LIGHT = Eigen::Vector3f(-0.4f, -0.5f, -0.77f);

cv::Vec3b toPixel(const Eigen::Vector3f& rgb, float brightness)
{
  const Eigen::Vector3f value = (255 * brightness * rgb).cwiseMin(255.0f).cwiseMax(0.0f);
  return {static_cast<uchar>(value.z()), static_cast<uchar>(value.y()), static_cast<uchar>(value.x())};
}

/// Median distance of neighbouring points.
double spacingOf(const OrientedPoints& cloud, double size)
{
  const KdTree tree(cloud.points);
  std::vector<double> distances;
  for (std::size_t i = 0; i < cloud.size(); i += std::max<std::size_t>(1, cloud.size() / 200))
  {
    std::vector<int> near;
    for (double radius = size / 1000; near.size() < 2 && radius < size; radius *= 1.5)
    {
      tree.radiusSearch(cloud.points[i], static_cast<float>(radius), near);
      if (near.size() >= 2)
        distances.push_back(radius);
    }
  }
  if (distances.empty())
    return size / 100;
  std::nth_element(distances.begin(), distances.begin() + static_cast<long>(distances.size() / 2), distances.end());
  return distances[distances.size() / 2];
}

Eigen::AlignedBox3f boxOf(const std::vector<ColoredCloud>& clouds)
{
  Eigen::AlignedBox3f box;
  for (const ColoredCloud& cloud : clouds)
    for (const auto& p : cloud.points.points)
      box.extend(p);
  return box;
}
}  // namespace

void saveCloudPicture(const std::vector<ColoredCloud>& clouds, const std::string& file)
{
  const Eigen::AlignedBox3f box = boxOf(clouds);
  if (box.isEmpty())
    throw ParameterError("There are no points to draw in " + file + ".");
  const auto size = static_cast<double>(box.sizes().head<2>().maxCoeff()) * 1.05;
  const double away = FAR_AWAY * size;
  const double focal = SIZE / size * away;
  const int width = std::max(8, static_cast<int>(std::ceil(SIZE * static_cast<double>(box.sizes().x()) * 1.05 / size)));
  const int height =
      std::max(8, static_cast<int>(std::ceil(SIZE * static_cast<double>(box.sizes().y()) * 1.05 / size)));
  Pose T = Pose::Identity();
  T.translation() = Eigen::Vector3d(0, 0, away) - box.center().cast<double>();
  DepthRenderer renderer(width, height, {focal, focal, width / 2.0, height / 2.0});
  for (std::size_t k = 0; k < clouds.size(); ++k)
    renderer.draw(clouds[k].points, T, std::max(0.9 * spacingOf(clouds[k].points, size), 0.6 * size / SIZE),
                  static_cast<std::int32_t>(k));
  const DepthGrid grid = renderer.grid();
  const auto normals = estimateGridNormals(grid, 2.5 * grid.pitch(away), Executor(0));
  cv::Mat picture(height, width, CV_8UC3, cv::Scalar(BACKGROUND[0], BACKGROUND[1], BACKGROUND[2]));
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u)
    {
      const int i = grid.index(u, v);
      const std::int32_t label = renderer.labels()[static_cast<std::size_t>(i)];
      if (label < 0)
        continue;
      const Eigen::Vector3f& n = normals[static_cast<std::size_t>(i)];
      const float brightness = std::isnan(n.x()) ? 0.6f : 0.35f + 0.65f * std::max(0.0f, n.dot(LIGHT));
      picture.at<cv::Vec3b>(v, u) = toPixel(clouds[static_cast<std::size_t>(label)].color, brightness);
    }
  writePicture(picture, file);
}

Eigen::Vector3f heat(double level)
{
  const double h = 4 * std::clamp(level, 0.0, 1.0);  // blue, cyan, green, yellow, red
  const auto ramp = [](double x) { return static_cast<float>(std::clamp(x, 0.0, 1.0)); };
  return {ramp(h - 2), ramp(h < 2 ? h : 4 - h), ramp(2 - h)};
}

OrientedPoints pointsOf(const DepthGrid& grid, const std::vector<bool>& keep)
{
  OrientedPoints points;
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (grid.valid(static_cast<int>(i)) && (keep.empty() || keep[i]))
    {
      points.points.push_back(grid.point(static_cast<int>(i)));
      points.normals.push_back(-points.points.back().normalized());
    }
  return points;
}

void saveGray(const std::vector<std::uint8_t>& gray, int width, int height, const std::string& file)
{
  writePicture(cv::Mat(height, width, CV_8U, const_cast<std::uint8_t*>(gray.data())), file);
}

void saveLabels(const std::vector<std::int32_t>& labels, int width, int height, const std::string& file)
{
  cv::Mat picture(height, width, CV_8UC3, cv::Scalar::all(0));
  for (std::size_t i = 0; i < labels.size(); ++i)
    if (labels[i] > 0)
    {
      // A step around the circle of hues that never comes back near to the last ones.
      const double hue = std::fmod(static_cast<double>(labels[i]) * 0.618034, 1.0);
      const auto wave = [hue](double shift) {
        return static_cast<float>(0.62 + 0.38 * std::cos(2 * M_PI * (hue + shift)));
      };
      picture.at<cv::Vec3b>(static_cast<int>(i) / width, static_cast<int>(i) % width) =
          toPixel({wave(0), wave(1.0 / 3), wave(2.0 / 3)}, 1);
    }
  writePicture(picture, file);
}
}  // namespace bin_picking::paper
