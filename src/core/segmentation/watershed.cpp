// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <opencv2/imgproc.hpp>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/segmentation/segmentation.hpp"
#include "distance_map.hpp"

// Algorithm 1 of the paper, one function per step that is more than a call. The paper leaves open where the
// background's marker comes from; here it is every pixel without data, without which the outermost segments would flood
// the background.

namespace bin_picking
{
namespace
{
cv::Mat whiteToBlack(const cv::Mat& image)
{
  cv::Mat result = image.clone();
  result.setTo(0, image == 255);
  return result;
}

/// With the diagonals, so that contours of all directions are seen; in floats, because it is negative on ridges.
cv::Mat laplacian(const cv::Mat& image)
{
  const cv::Mat kernel = (cv::Mat_<float>(3, 3) << 1, 1, 1, 1, -8, 1, 1, 1, 1);
  cv::Mat result;
  cv::filter2D(image, result, CV_32F, kernel, cv::Point(-1, -1), 0, cv::BORDER_REPLICATE);
  return result;
}

/// The image minus its Laplacian, clipped to 0 ... 255, in three channels as the watershed needs it.
cv::Mat sharpened(const cv::Mat& image, const cv::Mat& laplace)
{
  cv::Mat exact;
  image.convertTo(exact, CV_32F);
  cv::Mat clipped;
  cv::Mat(exact - laplace).convertTo(clipped, CV_8U);
  cv::Mat color;
  cv::cvtColor(clipped, color, cv::COLOR_GRAY2BGR);
  return color;
}

cv::Mat grayscale(const cv::Mat& color)
{
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

cv::Mat normalized(const cv::Mat& distance)
{
  cv::Mat result;
  cv::normalize(distance, result, 0, 1, cv::NORM_MINMAX);
  return result;
}

cv::Mat eroded(const cv::Mat& mask, int iterations)
{
  cv::Mat result;
  cv::erode(mask, result, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}), cv::Point(-1, -1), iterations);
  return result;
}

/// Markers 1 ... n, one per contour, and n + 1 for the background.
cv::Mat drawnContours(const cv::Mat& mask, const cv::Mat& background, int& num_markers)
{
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(mask, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE);
  num_markers = static_cast<int>(contours.size());
  cv::Mat markers = cv::Mat::zeros(mask.size(), CV_32S);
  for (int k = 0; k < num_markers; ++k)
    cv::drawContours(markers, contours, k, cv::Scalar(k + 1), cv::FILLED);
  markers.setTo(num_markers + 1, background);
  return markers;
}
}  // namespace

std::vector<std::int32_t> watershedSegments(const std::vector<std::uint8_t>& gray, int width, int height,
                                            const SegmentationParameters& parameters)
{
  if (width < 1 || height < 1 || gray.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    throw ParameterError("A gray image of " + std::to_string(gray.size()) + " values cannot be " +
                         std::to_string(width) + " x " + std::to_string(height) + " pixels; pass one value per pixel.");
  const cv::Mat I = cv::Mat(height, width, CV_8U, const_cast<std::uint8_t*>(gray.data()));  // step 1
  const cv::Mat B = whiteToBlack(I);                                                        // step 2
  const cv::Mat L = laplacian(B);                                                           // step 3
  const cv::Mat S = sharpened(B, L);                                                        // step 4
  cv::Mat G = grayscale(S);                                                                 // step 5
  G = G > parameters.t1;                                                                    // step 6
  const cv::Mat D = distanceToBlack(G);                                                     // step 7
  const cv::Mat N = normalized(D);                                                          // step 8
  const cv::Mat T = N > parameters.t2;                                                      // step 9
  const cv::Mat P = eroded(T, parameters.erosion);                                          // step 10
  int num_markers = 0;
  cv::Mat M = drawnContours(P, B == 0, num_markers);  // step 11
  cv::watershed(S, M);                                // step 12

  M.setTo(0, (M < 0) | (M > num_markers) | (B == 0));
  return std::vector<std::int32_t>(M.begin<std::int32_t>(), M.end<std::int32_t>());
}
}  // namespace bin_picking
