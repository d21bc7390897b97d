// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/detection_picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/evaluation/picture_file.hpp"
#include "part_drawing.hpp"

namespace bin_picking
{
namespace
{
constexpr int MIN_WIDTH = 900;          // pixels of the picture
constexpr float HIDDEN_DEPTH = 0.004f;  // metres behind the measured surface at which a part counts as hidden there
constexpr float VISIBLE_OPACITY = 0.6f;
constexpr float HIDDEN_OPACITY = 0.15f;

/// The background of the picture, enlarged.
cv::Mat depthBackground(const DepthGrid& grid, int scale)
{
  cv::Mat large;
  cv::resize(shadedDepth(grid), large, {}, scale, scale, cv::INTER_LINEAR);
  return large;
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
        camera_(enlarged(grid.camera, scale)),
        picture_(depthBackground(grid, scale)),
        nearest_(picture_.size(), CV_32F, cv::Scalar(std::numeric_limits<float>::infinity()))
  {}

  void paint(const std::vector<Detection>& detections, const std::vector<std::shared_ptr<const TrainedModel>>& models)
  {
    std::vector<PartDrawing> drawings;
    for (const auto& detection : detections)
    {
      const TrainedModel& model = *models.at(detection.model_index);
      drawings.push_back(drawPart(model.mesh, model.surface, model.parameters.surface_spacing,
                                  detection.T_camera_object, camera_, picture_.size()));
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
  void markNearest(const PartDrawing& drawing)
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

  void blend(const PartDrawing& drawing, const Eigen::Vector3f& rgb)
  {
    forEachPixel(drawing, [&](const cv::Point& at, std::size_t i) {
      const float opacity = isHidden(at, drawing.grid.z[i]) ? HIDDEN_OPACITY : VISIBLE_OPACITY;
      const cv::Scalar color = toScalar(rgb, shade(drawing.normals[i]));
      cv::Vec3f& pixel = picture_.at<cv::Vec3f>(at);
      for (int channel = 0; channel < 3; ++channel)
        pixel[channel] = (1 - opacity) * pixel[channel] + opacity * static_cast<float>(color[channel]);
    });
  }

  void outline(const PartDrawing& drawing, const Eigen::Vector3f& rgb)
  {
    cv::drawContours(picture_, contours(drawing), -1, toScalar(rgb, 1.0f), 1, cv::LINE_AA);
  }

  void writeLabel(const PartDrawing& drawing, std::size_t rank, double score)
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
  writePicture(withLegend(painter.picture(), result.message), path);
}
}  // namespace bin_picking
