// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/scene_picture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "part_drawing.hpp"

namespace bin_picking
{
namespace
{
constexpr int MAX_WIDTH = 960;      // pixels of the picture in the report
constexpr int OUTLINE_WIDTH = 900;  // small scans are drawn finer than their pixels, so that outlines are smooth
constexpr int JPEG_QUALITY = 82;
constexpr double SIMPLIFICATION = 0.6;  // pixels by which an outline may be off

std::string encode(const DepthGrid& grid)
{
  cv::Mat picture = shadedDepth(grid);
  if (picture.cols > MAX_WIDTH)
  {
    cv::Mat small;
    const double scale = static_cast<double>(MAX_WIDTH) / picture.cols;
    cv::resize(picture, small, {}, scale, scale, cv::INTER_AREA);
    picture = small;
  }
  picture.convertTo(picture, CV_8U);
  std::vector<uchar> bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, JPEG_QUALITY});
  return {bytes.begin(), bytes.end()};
}

Eigen::Vector2d middleOf(const PartDrawing& drawing)
{
  cv::Point2d sum(0, 0);
  int count = 0;
  forEachPixel(drawing, [&](const cv::Point& at, std::size_t) {
    sum += cv::Point2d(at);
    ++count;
  });
  return Eigen::Vector2d(sum.x, sum.y) / std::max(count, 1);
}

/// Draws parts `scale` times finer than the scan's pixels and gives their outlines in these.
class OutlineMaker
{
public:
  explicit OutlineMaker(const DepthGrid& grid)
      : scale_(std::max(1, (OUTLINE_WIDTH + grid.width - 1) / grid.width)),
        camera_(enlarged(grid.camera, scale_)),
        size_(grid.width * scale_, grid.height * scale_)
  {}

  Outline outline(const PartShape& shape, const Pose& T_camera_object) const
  {
    const PartDrawing drawing = drawPart(shape.mesh, {}, 0, T_camera_object, camera_, size_);
    std::ostringstream path;
    path.imbue(std::locale::classic());
    for (const auto& contour : contours(drawing))
    {
      std::vector<cv::Point> corners;
      cv::approxPolyDP(contour, corners, SIMPLIFICATION, true);
      if (corners.size() > 2)
        append(path, corners);
    }
    return {path.str(), (middleOf(drawing).array() + 0.5) / scale_};
  }

private:
  /// Absolute start, then steps: shorter than absolute corners.
  void append(std::ostream& path, const std::vector<cv::Point>& corners) const
  {
    for (std::size_t k = 0; k < corners.size(); ++k)
    {
      const cv::Point step = k == 0 ? corners[0] : corners[k] - corners[k - 1];
      const double middle = k == 0 ? 0.5 : 0;  // pixel centres lie half a pixel in
      path << (k == 0 ? "M" : "l") << rounded((step.x + middle) / scale_) << " " << rounded((step.y + middle) / scale_);
    }
    path << "z";
  }

  static double rounded(double pixels) { return std::round(pixels * 1000) / 1000; }

  int scale_;
  PinholeCamera camera_;
  cv::Size size_;
};
}  // namespace

ScenePicture drawScene(const DepthGrid& grid, const JudgedScene& scene, const PartShapes& shapes)
{
  if (grid.size() == 0)
    throw ParameterError("The grid has no pixels, so there is no picture to draw; pass the grid of the scan.");
  ScenePicture picture;
  picture.width = grid.width;
  picture.height = grid.height;
  picture.jpeg = encode(grid);
  const OutlineMaker maker(grid);
  for (const JudgedEstimate& judged : scene.estimates)
    picture.estimates.push_back(maker.outline(shapes.at(judged.estimate.part), judged.estimate.T_camera_object));
  for (std::size_t i = 0; i < scene.scene.instances.size(); ++i)
  {
    const TrueInstance& instance = scene.scene.instances[i];
    picture.instances.push_back(scene.found_by[i] ? Outline()
                                                  : maker.outline(shapes.at(instance.part), instance.T_camera_object));
  }
  return picture;
}
}  // namespace bin_picking
