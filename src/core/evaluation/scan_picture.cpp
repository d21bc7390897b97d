// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/scan_picture.hpp"

#include "bin_picking_perception/evaluation/detection_picture.hpp"
#include "bin_picking_perception/evaluation/picture_file.hpp"
#include "part_drawing.hpp"

namespace bin_picking
{
void saveScanPicture(const DepthGrid& grid, const std::vector<std::int32_t>& labels, const std::string& path)
{
  constexpr std::size_t COLORS = 6;  // that differ; the ranks beyond share one
  const cv::Mat shaded = shadedDepth(grid);
  cv::Mat picture(shaded.size(), CV_8UC3);
  for (std::size_t i = 0; i < labels.size(); ++i)
  {
    const cv::Point pixel(static_cast<int>(i) % grid.width, static_cast<int>(i) / grid.width);
    Eigen::Vector3f tint = Eigen::Vector3f::Ones();
    if (labels[i] >= 0 && grid.valid(static_cast<int>(i)))
      tint = 0.55f * rankColor(static_cast<std::size_t>(labels[i]) % COLORS) + Eigen::Vector3f::Constant(0.5f);
    const cv::Vec3f gray = shaded.at<cv::Vec3f>(pixel);
    for (int channel = 0; channel < 3; ++channel)
      picture.at<cv::Vec3b>(pixel)[channel] = cv::saturate_cast<uchar>(gray[channel] * tint[2 - channel]);
  }
  writePicture(picture, path);
}
}  // namespace bin_picking
