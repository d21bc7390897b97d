// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/scene/bin.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
class Executor;

enum class SegmentationMethod
{
  None,       ///< the whole region is one segment
  Watershed,  ///< Algorithm 1 of the paper, on the gray image
  DepthEdges  ///< regions between depth discontinuities, in metres
};

struct SegmentationParameters
{
  SegmentationMethod method = SegmentationMethod::DepthEdges;
  int step = 2;          // of the pixels that are looked at, along rows and columns
  bool veto = false;     // true: only candidate targets are matched (paper); false: they only come first
  double gray_near = 0;  // depth that maps to the brightest gray; both 0: from the bin or the data
  double gray_far = 0;
  int t1 = 40;                   // Algorithm 1, line 6
  double t2 = 0.4;               // Algorithm 1, line 9
  int erosion = 1;               // Algorithm 1, line 10: iterations of a 3 x 3 element
  double min_pixel_ratio = 0.6;  // candidate: pixels against the one-sided views of the part
  double max_pixel_ratio = 1.3;
  double min_contour_ratio = 0.5;
  double max_contour_ratio = 1.6;
  double edge_depth = 0.004;       // DepthEdges: smallest jump, metres
  double neck = 0.6;               // DepthEdges: narrowest passage within a segment, of the width of its narrower end
  double min_segment_area = 0.02;  // of the largest one-sided view

  void visit(ParameterVisitor& v);
};

struct Segment
{
  int label = 0;          ///< in Segmentation::labels
  int pixels = 0;         ///< of the thinned grid
  double area = 0;        ///< sum of pixel areas perpendicular to the rays, square metres
  double contour = 0;     ///< metres
  double mean_depth = 0;  ///< metres
};

struct Segmentation
{
  int width = 0;  ///< of the thinned grid
  int height = 0;
  int step = 1;                      ///< pixels of the given grid from one of the thinned grid to the next
  std::vector<std::uint8_t> gray;    ///< 255 = near end, 1 = far end, 0 = no data
  std::vector<std::int32_t> labels;  ///< 0: none or border
  std::vector<Segment> segments;

  /// Label at a pixel of the given grid.
  std::int32_t labelAt(int u, int v) const
  {
    return labels[static_cast<std::size_t>(v / step) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(u / step)];
  }
};

/// Depth mapped to gray over the effective range (Section 2.2.1): gray_near -> 255, gray_far -> 1, no data -> 0. Where
/// the parameters give no range it is taken from the bin (floor to rim, clipped to the data), else from the 1st and
/// 99th percentile of the data.
std::vector<std::uint8_t> depthToGray(const DepthGrid& grid, const SegmentationParameters& parameters, const Bin* bin);

/// The twelve steps of Algorithm 1 on a gray image; labels 1..n, 0 = border or background.
std::vector<std::int32_t> watershedSegments(const std::vector<std::uint8_t>& gray, int width, int height,
                                            const SegmentationParameters& parameters);

/// Segments of the grid, thinned by `step`, by the chosen method. Deterministic.
Segmentation segmentScene(const DepthGrid& grid, const SegmentationParameters& parameters, const Bin* bin,
                          const Executor& executor);

/// A segment that looks like one whole part from some side.
struct CandidateTarget
{
  int label = 0;
  double pixel_ratio = 0;    ///< pixels of the segment / pixels of the best fitting one-sided view at its depth
  double contour_ratio = 0;  ///< the same for contour pixels
  double priority = 0;       ///< larger first: visible area and height
};

/// Segments whose pixel and contour counts are similar to those of a one-sided view of the part (views are scaled to
/// the segment's depth), best first. \param all also those that fail (with their ratios), after the others
std::vector<CandidateTarget> selectCandidates(const Segmentation& segmentation, const DepthGrid& grid,
                                              const TrainedModel& model, const SegmentationParameters& parameters,
                                              bool all = false);
}  // namespace bin_picking
