// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/detection_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "bin_picking_perception/segmentation/segmentation.hpp"

namespace bin_picking
{
namespace
{
constexpr int MIN_WIDTH = 900;          // pixels of the picture
constexpr float HIDDEN_DEPTH = 0.004f;  // metres behind the measured surface at which a part counts as hidden there
constexpr float VISIBLE_OPACITY = 0.6f;
constexpr float HIDDEN_OPACITY = 0.15f;
constexpr double NORMAL_PIXELS = 1.5;                                 // window of the normals that shade a surface
const cv::Vec3f NO_DATA(34, 26, 22);                                  // blue, green, red
const Eigen::Vector3f LIGHT = Eigen::Vector3f(-0.4f, -0.5f, -0.77f);  // from the upper left, behind the camera

/// Brightness of a surface under the light, [0, 1]; the light also reaches what is turned away a little.
float shade(const Eigen::Vector3f& normal)
{
  return std::isnan(normal.x()) ? 0.5f : 0.3f + 0.7f * std::max(0.0f, normal.dot(LIGHT));
}

std::vector<Eigen::Vector3f> pictureNormals(const DepthGrid& grid, double depth)
{
  return estimateGridNormals(grid, NORMAL_PIXELS * grid.pitch(depth), Executor(1));
}

PinholeCamera scaled(const PinholeCamera& c, int scale)
{
  const double middle = (scale - 1) / 2.0;  // pixel 0 becomes pixels 0 ... scale - 1
  return {c.fx * scale, c.fy * scale, c.cx * scale + middle, c.cy * scale + middle};
}

/// The measured depth as gray, near is bright, with a touch of relief.
cv::Mat depthBackground(const DepthGrid& grid, int scale)
{
  const auto gray = depthToGray(grid, SegmentationParameters(), nullptr);
  const auto middle = std::find_if(grid.z.begin(), grid.z.end(), [](float z) { return !std::isnan(z); });
  const auto normals = pictureNormals(grid, middle == grid.z.end() ? 1.0 : static_cast<double>(*middle));
  cv::Mat picture(grid.height, grid.width, CV_32FC3, cv::Scalar(NO_DATA[0], NO_DATA[1], NO_DATA[2]));
  for (std::size_t i = 0; i < gray.size(); ++i)
  {
    if (gray[i] == 0)
      continue;
    const float level = (0.25f + 0.75f * static_cast<float>(gray[i]) / 255) * (0.35f + 0.65f * shade(normals[i])) * 230;
    picture.at<cv::Vec3f>(static_cast<int>(i) / grid.width, static_cast<int>(i) % grid.width) = {level, level, level};
  }
  cv::Mat large;
  cv::resize(picture, large, {}, scale, scale, cv::INTER_LINEAR);
  return large;
}

/// A part drawn alone, in the part of the picture that it covers.
struct Drawing
{
  cv::Rect window;
  DepthGrid grid;
  std::vector<Eigen::Vector3f> normals;
};

cv::Rect coveredWindow(const std::vector<Eigen::Vector3f>& points, const Pose& T_camera_object,
                       const PinholeCamera& camera, const cv::Size& size)
{
  Eigen::Vector2d low(size.width, size.height);
  Eigen::Vector2d high(-1, -1);
  for (const auto& point : points)
  {
    const Eigen::Vector3d p = T_camera_object * point.cast<double>();
    if (p.z() <= 0)
      continue;
    low = low.cwiseMin(camera.project(p));
    high = high.cwiseMax(camera.project(p));
  }
  const cv::Point corner(static_cast<int>(std::max(0.0, low.x() - 3)), static_cast<int>(std::max(0.0, low.y() - 3)));
  const cv::Point opposite(static_cast<int>(std::min(size.width - 1.0, high.x() + 3)),
                           static_cast<int>(std::min(size.height - 1.0, high.y() + 3)));
  return opposite.x < corner.x || opposite.y < corner.y ? cv::Rect() : cv::Rect(corner, opposite + cv::Point(1, 1));
}

Drawing drawPart(const TrainedModel& model, const Pose& T_camera_object, const PinholeCamera& camera,
                 const cv::Size& size)
{
  Drawing drawing;
  const bool has_mesh = !model.mesh.empty();
  drawing.window = coveredWindow(has_mesh ? model.mesh.vertices : model.surface.points, T_camera_object, camera, size);
  if (drawing.window.empty())
    return drawing;
  DepthRenderer renderer(drawing.window.width, drawing.window.height,
                         {camera.fx, camera.fy, camera.cx - drawing.window.x, camera.cy - drawing.window.y});
  if (has_mesh)
    renderer.draw(model.mesh, T_camera_object, 0);
  else
    renderer.draw(model.surface, T_camera_object, model.parameters.surface_spacing, 0);
  drawing.grid = renderer.grid();
  drawing.normals = pictureNormals(drawing.grid, std::max(1e-3, T_camera_object.translation().z()));
  return drawing;
}

cv::Scalar toScalar(const Eigen::Vector3f& rgb, float brightness)
{
  return {static_cast<double>(255 * brightness * rgb.z()), static_cast<double>(255 * brightness * rgb.y()),
          static_cast<double>(255 * brightness * rgb.x())};
}

class Painter
{
public:
  Painter(const DepthGrid& grid, int scale)
      : grid_(grid),
        scale_(scale),
        camera_(scaled(grid.camera, scale)),
        picture_(depthBackground(grid, scale)),
        nearest_(picture_.size(), CV_32F, cv::Scalar(std::numeric_limits<float>::infinity()))
  {}

  void paint(const std::vector<Detection>& detections, const std::vector<std::shared_ptr<const TrainedModel>>& models)
  {
    std::vector<Drawing> drawings;
    for (const auto& detection : detections)
    {
      drawings.push_back(
          drawPart(*models.at(detection.model_index), detection.T_camera_object, camera_, picture_.size()));
      markNearest(drawings.back());
    }
    for (std::size_t k = drawings.size(); k-- > 0;)  // the best one last, on top
      blend(drawings[k], rankColor(k));
    picture_.convertTo(picture_, CV_8U);
    for (std::size_t k = drawings.size(); k-- > 0;)
      outline(drawings[k], rankColor(k));
    for (std::size_t k = 0; k < drawings.size(); ++k)
      writeLabel(drawings[k], k, detections[k].score);
  }

  const cv::Mat& picture() const { return picture_; }

private:
  /// Calls paint(point in the picture, index into the drawing) for every pixel that the part covers.
  template <typename Function>
  static void forEachPixel(const Drawing& drawing, const Function& paint)
  {
    for (int v = 0; v < drawing.window.height; ++v)
      for (int u = 0; u < drawing.window.width; ++u)
        if (const int i = drawing.grid.index(u, v); drawing.grid.valid(i))
          paint(cv::Point(u, v) + drawing.window.tl(), static_cast<std::size_t>(i));
  }

  void markNearest(const Drawing& drawing)
  {
    forEachPixel(drawing, [&](const cv::Point& at, std::size_t i) {
      nearest_.at<float>(at) = std::min(nearest_.at<float>(at), drawing.grid.z[i]);
    });
  }

  /// Behind the measured surface or behind another found part.
  bool isHidden(const cv::Point& at, float depth) const
  {
    const float measured = grid_.z[static_cast<std::size_t>(grid_.index(at.x / scale_, at.y / scale_))];
    return depth > measured + HIDDEN_DEPTH || depth > nearest_.at<float>(at) + HIDDEN_DEPTH / 4;
  }

  void blend(const Drawing& drawing, const Eigen::Vector3f& rgb)
  {
    forEachPixel(drawing, [&](const cv::Point& at, std::size_t i) {
      const float opacity = isHidden(at, drawing.grid.z[i]) ? HIDDEN_OPACITY : VISIBLE_OPACITY;
      const cv::Scalar color = toScalar(rgb, shade(drawing.normals[i]));
      cv::Vec3f& pixel = picture_.at<cv::Vec3f>(at);
      for (int channel = 0; channel < 3; ++channel)
        pixel[channel] = (1 - opacity) * pixel[channel] + opacity * static_cast<float>(color[channel]);
    });
  }

  void outline(const Drawing& drawing, const Eigen::Vector3f& rgb)
  {
    if (drawing.window.empty())
      return;
    cv::Mat mask = cv::Mat::zeros(drawing.window.size(), CV_8U);
    forEachPixel(drawing,
                 [&](const cv::Point& at, std::size_t) { mask.at<std::uint8_t>(at - drawing.window.tl()) = 255; });
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(mask, contours, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE, drawing.window.tl());
    cv::drawContours(picture_, contours, -1, toScalar(rgb, 1.0f), 1, cv::LINE_AA);
  }

  void writeLabel(const Drawing& drawing, std::size_t rank, double score)
  {
    cv::Point2d sum(0, 0);
    double count = 0;
    forEachPixel(drawing, [&](const cv::Point& at, std::size_t i) {
      const double weight = isHidden(at, drawing.grid.z[i]) ? 1e-3 : 1.0;  // in the visible part, if there is one
      sum += weight * cv::Point2d(at);
      count += weight;
    });
    if (count == 0)
      return;
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%zu: %.2f", rank + 1, score);
    int baseline = 0;
    const cv::Size size = cv::getTextSize(text.data(), cv::FONT_HERSHEY_SIMPLEX, 0.5, 1, &baseline);
    const cv::Point centre(static_cast<int>(sum.x / count), static_cast<int>(sum.y / count));
    const cv::Point at =
        freePlace({centre - cv::Point(size.width / 2, size.height / 2), size}).tl() + cv::Point(0, size.height);
    cv::putText(picture_, text.data(), at, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar::all(0), 3, cv::LINE_AA);
    cv::putText(picture_, text.data(), at, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar::all(255), 1, cv::LINE_AA);
  }

  /// The wanted place of a label, or the next one below that no better rank has taken.
  cv::Rect freePlace(cv::Rect place)
  {
    const auto taken = [&](const cv::Rect& other) { return (other & place).area() > 0; };
    while (place.y + place.height < picture_.rows && std::any_of(labels_.begin(), labels_.end(), taken))
      place.y += 2;
    labels_.push_back(place);
    return place;
  }

  const DepthGrid& grid_;
  int scale_;
  PinholeCamera camera_;
  cv::Mat picture_;
  cv::Mat nearest_;
  std::vector<cv::Rect> labels_;
};

/// The text under the picture, broken where it is too long.
cv::Mat withLegend(const cv::Mat& picture, const std::string& message)
{
  const int margin = 12;
  const int line_height = 24;
  std::vector<std::string> lines = {""};
  std::istringstream words(message);
  int baseline = 0;
  for (std::string word; words >> word;)
  {
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (cv::getTextSize(longer, cv::FONT_HERSHEY_SIMPLEX, 0.55, 1, &baseline).width <= picture.cols - 2 * margin)
      lines.back() = longer;
    else
      lines.push_back(word);
  }
  cv::Mat result;
  cv::copyMakeBorder(picture, result, 0, static_cast<int>(lines.size()) * line_height + margin, 0, 0,
                     cv::BORDER_CONSTANT, cv::Scalar::all(16));
  int y = picture.rows;
  for (const auto& line : lines)
    cv::putText(result, line, {margin, y += line_height}, cv::FONT_HERSHEY_SIMPLEX, 0.55, cv::Scalar::all(225), 1,
                cv::LINE_AA);
  return result;
}
}  // namespace

Eigen::Vector3f rankColor(std::size_t rank)
{
  static const std::array<Eigen::Vector3f, 6> COLORS = {
      Eigen::Vector3f(0.95f, 0.15f, 0.12f), Eigen::Vector3f(1.00f, 0.55f, 0.05f), Eigen::Vector3f(0.98f, 0.88f, 0.15f),
      Eigen::Vector3f(0.20f, 0.80f, 0.25f), Eigen::Vector3f(0.20f, 0.45f, 1.00f), Eigen::Vector3f(0.68f, 0.35f, 0.95f)};
  return COLORS[std::min(rank, COLORS.size() - 1)];
}

void saveDetectionPicture(const DepthGrid& grid, const DetectionResult& result,
                          const std::vector<std::shared_ptr<const TrainedModel>>& models, const std::string& path)
{
  if (grid.size() == 0)
    throw ParameterError("The grid has no pixels, so there is no picture to write; pass the grid of a cloud.");
  Painter painter(grid, std::max(1, (MIN_WIDTH + grid.width - 1) / grid.width));
  painter.paint(result.detections, models);
  bool written = false;
  std::string reason;
  try
  {
    written = cv::imwrite(path, withLegend(painter.picture(), result.message));
  }
  catch (const cv::Exception& e)
  {
    reason = " (" + e.err + ")";
  }
  if (!written)
    throw FileError("The picture cannot be written to " + path + reason +
                    "; the folder must exist and the name end in .png or .jpg.");
}
}  // namespace bin_picking
