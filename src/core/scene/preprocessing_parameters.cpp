// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/scene/preprocessing.hpp"

namespace bin_picking
{
void PreprocessingParameters::visit(ParameterVisitor& v)
{
  v.field({"pixels_per_leaf", "",
           "working resolution: pixels are merged until about this many fit in a leaf; more is finer "
           "and slower",
           0.5, 50},
          pixels_per_leaf);
  v.field(
      {"outlier_window", "px", "half size of the window in which a point needs neighbours; 0 keeps every point", 0, 20},
      outlier_window);
  v.field({"outlier_min_share", "", "a point with a smaller share of near neighbours in the window is dropped", 0, 1},
          outlier_min_share);
  v.field({"outlier_distance", "m", "depth difference up to which a neighbour counts as near; grows with the distance",
           0.0001, 1},
          outlier_distance);
  v.field({"max_normal_tilt", "rad", "surfaces turned further away from the camera are not sampled", 0.1, 1.5708},
          max_normal_tilt);
  v.field({"split_by_normal", "", "a leaf with several surface directions keeps one sample for each (up to three)"},
          split_by_normal);
}
}  // namespace bin_picking
