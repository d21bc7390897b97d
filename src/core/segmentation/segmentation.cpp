// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/segmentation/segmentation.hpp"

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/view_templates.hpp"
#include "depth_edge_segments.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t MAX_SPECK_PIXELS = 9;

/// The picture that Algorithm 1 starts from has a white background (its step 2 turns it black). Data is never white
/// then.
std::vector<std::uint8_t> onWhite(std::vector<std::uint8_t> gray)
{
  for (auto& level : gray)
    level = level == 0 ? 255 : std::min<std::uint8_t>(level, 254);
  return gray;
}

struct Box
{
  int u_min = std::numeric_limits<int>::max();
  int u_max = -1;
  int v_min = std::numeric_limits<int>::max();
  int v_max = -1;
};

/// Every step-th pixel of every step-th row. Unlike means of blocks these keep the area of a part, whose border blocks
/// are only partly measured.
DepthGrid thinned(const DepthGrid& fine, const Box& box, int step)
{
  const PinholeCamera& c = fine.camera;
  DepthGrid grid = makeGrid((box.u_max - box.u_min) / step + 1, (box.v_max - box.v_min) / step + 1,
                            {c.fx / step, c.fy / step, (c.cx - box.u_min) / step, (c.cy - box.v_min) / step});
  std::size_t to = 0;
  for (int v = box.v_min; v <= box.v_max; v += step)
    for (int u = box.u_min; u <= box.u_max; u += step, ++to)
    {
      const auto from = static_cast<std::size_t>(fine.index(u, v));
      grid.x[to] = fine.x[from];
      grid.y[to] = fine.y[from];
      grid.z[to] = fine.z[from];
    }
  return grid;
}

/// What holds all measured pixels with a border of pixels without data, as far as the picture goes, so that it is
/// divided as the whole picture would be; it begins at multiples of the step. Empty if nothing is measured.
Box measuredPart(const DepthGrid& grid, int step)
{
  Box box;
  for (int v = 0; v < grid.height; ++v)
    for (int u = 0; u < grid.width; ++u)
      if (grid.valid(grid.index(u, v)))
        box = {std::min(box.u_min, u), std::max(box.u_max, u), std::min(box.v_min, v), v};
  if (box.u_max < 0)
    return box;
  const auto before = [&](int first) { return std::max(0, first / step - 1) * step; };
  return {before(box.u_min), std::min(grid.width - 1, box.u_max + step), before(box.v_min),
          std::min(grid.height - 1, box.v_max + step)};
}

/// The values of a part of the picture in the whole, 0 around them.
template <typename Value>
std::vector<Value> placed(const std::vector<Value>& part, int part_width, int u, int v, int width, int height)
{
  std::vector<Value> whole(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  for (std::size_t from = 0; from < part.size(); from += static_cast<std::size_t>(part_width), ++v)
    std::copy_n(part.begin() + static_cast<std::ptrdiff_t>(from), part_width,
                whole.begin() + static_cast<std::ptrdiff_t>(v) * width + u);
  return whole;
}

std::vector<std::int32_t> labelScene(const DepthGrid& grid, const std::vector<std::uint8_t>& gray,
                                     const SegmentationParameters& parameters, const Executor& executor)
{
  switch (parameters.method)
  {
    case SegmentationMethod::Watershed:
      return watershedSegments(onWhite(gray), grid.width, grid.height, parameters);
    case SegmentationMethod::DepthEdges:
      return depthEdgeSegments(grid, parameters.edge_depth, parameters.neck, executor);
    case SegmentationMethod::None:
      break;
  }
  std::vector<std::int32_t> labels(grid.size(), 0);
  std::transform(grid.z.begin(), grid.z.end(), labels.begin(), [](float z) { return std::isnan(z) ? 0 : 1; });
  return labels;
}

/// Sets small groups of zeros within a border of zeros. Missing pixels are not contours; the views, which are compared
/// with, have none.
void fillSpecks(std::vector<std::uint8_t>& mask, int width)
{
  constexpr std::uint8_t SEEN = 2;
  std::vector<std::size_t> group;
  const auto take = [&](std::size_t i) {
    if (mask[i] != 0)
      return;
    mask[i] = SEEN;
    group.push_back(i);
  };
  const auto row = static_cast<std::size_t>(width);
  for (std::size_t i = 0; i < mask.size(); ++i)
  {
    group.clear();
    take(i);
    for (std::size_t k = 0; k < group.size(); ++k)
    {
      const std::size_t j = group[k];
      const std::size_t column = j % row;
      if (column > 0)
        take(j - 1);
      if (column + 1 < row)
        take(j + 1);
      if (j >= row)
        take(j - row);
      if (j + row < mask.size())
        take(j + row);
    }
    if (group.size() <= MAX_SPECK_PIXELS)
      for (const std::size_t j : group)
        mask[j] = 1;
  }
  std::replace(mask.begin(), mask.end(), SEEN, std::uint8_t{0});
}

/// Length of the contours of one label, pixels; measured as those of the model's views are.
double contourPixels(const Segmentation& segmentation, int label, const Box& box)
{
  // One pixel of margin closes contours at the frame.
  const int width = box.u_max - box.u_min + 3;
  const int height = box.v_max - box.v_min + 3;
  std::vector<std::uint8_t> mask(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  for (int v = box.v_min; v <= box.v_max; ++v)
  {
    const std::int32_t* from = segmentation.labels.data() + (v * segmentation.width + box.u_min);
    std::uint8_t* to = mask.data() + ((v - box.v_min + 1) * width + 1);
    std::transform(from, from + (box.u_max - box.u_min + 1), to,
                   [&](std::int32_t other) { return static_cast<std::uint8_t>(other == label ? 1 : 0); });
  }
  fillSpecks(mask, width);
  return contourLength(mask, width, height);
}

std::vector<Segment> measureSegments(const Segmentation& segmentation, const DepthGrid& grid, const Executor& executor)
{
  const int num_labels =
      segmentation.labels.empty() ? 0 : *std::max_element(segmentation.labels.begin(), segmentation.labels.end());
  std::vector<Segment> segments(static_cast<std::size_t>(num_labels));
  std::vector<Box> boxes(segments.size());
  for (int v = 0; v < grid.height; ++v)
  {
    for (int u = 0; u < grid.width; ++u)
    {
      const auto i = static_cast<std::size_t>(grid.index(u, v));
      if (segmentation.labels[i] == 0)
        continue;
      const auto k = static_cast<std::size_t>(segmentation.labels[i] - 1);
      const double z = static_cast<double>(grid.z[i]);
      segments[k].label = segmentation.labels[i];
      segments[k].pixels += 1;
      segments[k].area += grid.pitch(z) * grid.pitch(z);
      segments[k].mean_depth += z;
      boxes[k] = {std::min(boxes[k].u_min, u), std::max(boxes[k].u_max, u), std::min(boxes[k].v_min, v),
                  std::max(boxes[k].v_max, v)};
    }
  }
  executor.forEach(segments.size(), [&](std::size_t k) {
    if (segments[k].pixels == 0)
      return;
    segments[k].mean_depth /= segments[k].pixels;
    segments[k].contour = contourPixels(segmentation, segments[k].label, boxes[k]) * grid.pitch(segments[k].mean_depth);
  });
  // A marker can lose all its pixels to the borders of its neighbours.
  segments.erase(
      std::remove_if(segments.begin(), segments.end(), [](const Segment& segment) { return segment.pixels == 0; }),
      segments.end());
  return segments;
}
}  // namespace

Segmentation segmentScene(const DepthGrid& scene, const SegmentationParameters& parameters, const Bin* bin,
                          const Executor& executor)
{
  const int step = parameters.step;
  const int width = (scene.width + step - 1) / step;
  const int height = (scene.height + step - 1) / step;
  Segmentation segmentation;
  segmentation.step = step;
  const Box box = measuredPart(scene, step);
  if (box.u_max >= 0)
  {
    const DepthGrid grid = thinned(scene, box, step);
    segmentation.width = grid.width;
    segmentation.height = grid.height;
    segmentation.gray = depthToGray(grid, parameters, bin);
    segmentation.labels = labelScene(grid, segmentation.gray, parameters, executor);
    segmentation.segments = measureSegments(segmentation, grid, executor);
  }
  const int u = std::min(box.u_min / step, width);
  const int v = std::min(box.v_min / step, height);
  segmentation.gray = placed(segmentation.gray, segmentation.width, u, v, width, height);
  segmentation.labels = placed(segmentation.labels, segmentation.width, u, v, width, height);
  segmentation.width = width;
  segmentation.height = height;
  return segmentation;
}
}  // namespace bin_picking
