// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <opencv2/imgproc.hpp>

namespace bin_picking
{
/// Distance in pixels from each white pixel to the nearest black one. What lies outside of the picture counts as black,
/// so that a picture without a black pixel has distances too.
inline cv::Mat distanceToBlack(const cv::Mat& mask)
{
  cv::Mat padded;
  cv::copyMakeBorder(mask, padded, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::Mat distance;
  cv::distanceTransform(padded, distance, cv::DIST_L2, cv::DIST_MASK_5);
  return distance(cv::Rect(1, 1, mask.cols, mask.rows)).clone();
}
}  // namespace bin_picking
