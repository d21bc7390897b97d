// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/segmentation/segmentation.hpp"

namespace bin_picking
{
void SegmentationParameters::visit(ParameterVisitor& v)
{
  v.field({"method", "", "how the scene is divided: not at all, by Algorithm 1 on the gray image, or at depth edges"},
          method,
          {{"none", SegmentationMethod::None},
           {"watershed", SegmentationMethod::Watershed},
           {"depth_edges", SegmentationMethod::DepthEdges}});
  v.field({"step", "px",
           "only every so many-th pixel of a row or column is looked at; larger is faster and sees less of narrow gaps",
           1, 8},
          step);
  v.field({"veto", "", "only candidate targets are matched; otherwise they come first and the rest follows"}, veto);
  v.field({"gray_near", "m", "depth shown as the brightest gray; 0 with gray_far 0: from the bin or the data", 0, 100},
          gray_near);
  v.field({"gray_far", "m", "depth shown as the darkest gray; 0 with gray_near 0: from the bin or the data", 0, 100},
          gray_far);
  v.field(
      {"t1", "", "watershed: gray level above which a pixel can belong to a part; larger ignores deeper parts", 0, 254},
      t1);
  v.field({"t2", "",
           "watershed: share of the largest distance above which a marker begins; larger separates touching parts "
           "and loses small ones",
           0, 0.99},
          t2);
  v.field({"erosion", "px", "watershed: erosion of the markers; larger separates more and loses small parts", 0, 20},
          erosion);
  v.field({"min_pixel_ratio", "", "candidates have at least this share of the pixels of a one-sided view", 0, 10},
          min_pixel_ratio);
  v.field({"max_pixel_ratio", "", "candidates have at most this multiple of the pixels of a one-sided view", 0, 10},
          max_pixel_ratio);
  v.field({"min_contour_ratio", "", "candidates have at least this share of the contour of a one-sided view", 0, 10},
          min_contour_ratio);
  v.field({"max_contour_ratio", "", "candidates have at most this multiple of the contour of a one-sided view", 0, 10},
          max_contour_ratio);
  v.field({"edge_depth", "m",
           "depth edges: smallest depth jump that separates two segments; larger merges touching parts", 0.0005, 0.1},
          edge_depth);
  v.field({"neck", "",
           "depth edges: a segment is cut where it is narrower than this share of its narrower end; larger cuts "
           "more",
           0, 1},
          neck);
  v.field({"min_segment_area", "", "segments below this share of the largest one-sided view are ignored", 0, 1},
          min_segment_area);
}
}  // namespace bin_picking
