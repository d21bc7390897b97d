// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <opencv2/imgproc.hpp>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/view_templates.hpp"

namespace bin_picking
{
namespace
{
/// Steps of a closed chain of neighbouring pixels: even ones run along the grid, odd ones across it.
double chainLength(const std::vector<cv::Point>& chain)
{
  if (chain.size() < 2)
    return 0;
  int even = 0;
  int odd = 0;
  int corners = 0;
  cv::Point previous = chain.front() - chain.back();
  for (std::size_t i = 0; i < chain.size(); ++i)
  {
    const cv::Point step = chain[(i + 1) % chain.size()] - chain[i];
    (step.x != 0 && step.y != 0 ? odd : even) += 1;
    corners += step != previous ? 1 : 0;
    previous = step;
  }
  // Vossepoel and Smeulders: coefficients that make the length of straight lines of all directions right on average.
  return 0.980 * even + 1.406 * odd - 0.091 * corners;
}
}  // namespace

double contourLength(const std::vector<std::uint8_t>& mask, int width, int height)
{
  if (width < 1 || height < 1 || mask.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(height))
    throw ParameterError("a mask of " + std::to_string(mask.size()) + " values cannot be " + std::to_string(width) +
                         " x " + std::to_string(height) + " pixels; pass one value per pixel");
  const cv::Mat image = cv::Mat(height, width, CV_8UC1, const_cast<std::uint8_t*>(mask.data())) != 0;
  std::vector<std::vector<cv::Point>> chains;
  std::vector<cv::Vec4i> hierarchy;
  cv::findContours(image, chains, hierarchy, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE);
  double length = 0;
  for (std::size_t i = 0; i < chains.size(); ++i)
  {
    // The chain runs through the middle of the region's own pixels, half a pixel inside an outer contour and half a
    // pixel outside a hole: a closed curve is longer by 2 pi times its offset.
    const bool is_hole = hierarchy[i][3] >= 0;
    length += chainLength(chains[i]) + (is_hole ? -CV_PI : CV_PI);
  }
  return length;
}
}  // namespace bin_picking
