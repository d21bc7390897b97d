// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/segmentation/segmentation.hpp"

namespace bin_picking
{
namespace
{
/// Ratios to the one-sided view that fits best: both as near to 1 as can be, too large and too small alike.
void compareWithViews(const Segment& segment, double pitch, const std::vector<ViewTemplate>& views,
                      CandidateTarget& target)
{
  double best = std::numeric_limits<double>::infinity();
  for (const ViewTemplate& view : views)
  {
    // A view in pixels is its area over the pitch squared and its contour over the pitch, at the depth of the segment.
    const double pixel_ratio = segment.pixels * pitch * pitch / static_cast<double>(view.area);
    const double contour_ratio = segment.contour / static_cast<double>(view.contour);
    const double misfit = std::abs(std::log(pixel_ratio)) + std::abs(std::log(contour_ratio));
    if (misfit < best)
    {
      best = misfit;
      target.pixel_ratio = pixel_ratio;
      target.contour_ratio = contour_ratio;
    }
  }
}

bool isSimilar(const CandidateTarget& target, const SegmentationParameters& parameters)
{
  return target.pixel_ratio >= parameters.min_pixel_ratio && target.pixel_ratio <= parameters.max_pixel_ratio &&
         target.contour_ratio >= parameters.min_contour_ratio && target.contour_ratio <= parameters.max_contour_ratio;
}

double largestArea(const std::vector<ViewTemplate>& views)
{
  double largest = 0;
  for (const ViewTemplate& view : views)
    largest = std::max(largest, static_cast<double>(view.area));
  return largest;
}

/// 0 at the lowest segment of the scene, 1 at the highest.
double relativeHeight(const Segment& segment, const std::vector<Segment>& segments)
{
  const auto deeper = [](const Segment& a, const Segment& b) { return a.mean_depth < b.mean_depth; };
  const auto [highest, lowest] = std::minmax_element(segments.begin(), segments.end(), deeper);
  const double range = lowest->mean_depth - highest->mean_depth;
  return range > 0 ? (lowest->mean_depth - segment.mean_depth) / range : 1.0;
}
}  // namespace

std::vector<CandidateTarget> selectCandidates(const Segmentation& segmentation, const DepthGrid& grid,
                                              const TrainedModel& model, const SegmentationParameters& parameters,
                                              bool all)
{
  const double min_area = parameters.min_segment_area * largestArea(model.views);
  std::vector<CandidateTarget> similar;
  std::vector<CandidateTarget> others;
  for (const Segment& segment : segmentation.segments)
  {
    if (segment.area < min_area)
      continue;
    CandidateTarget target;
    target.label = segment.label;
    compareWithViews(segment, segmentation.step * grid.pitch(segment.mean_depth), model.views, target);
    // A part that lies free on top is the easiest to take.
    target.priority = (std::min(1.0, target.pixel_ratio) + relativeHeight(segment, segmentation.segments)) / 2;
    // A point model without views gives nothing to compare with: every segment may be the part.
    (model.views.empty() || isSimilar(target, parameters) ? similar : others).push_back(target);
  }
  const auto better = [](const CandidateTarget& a, const CandidateTarget& b) {
    return a.priority > b.priority || (a.priority == b.priority && a.label < b.label);
  };
  std::sort(similar.begin(), similar.end(), better);
  std::sort(others.begin(), others.end(), better);
  if (all)
    similar.insert(similar.end(), others.begin(), others.end());
  return similar;
}
}  // namespace bin_picking
