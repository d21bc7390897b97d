// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/rivals.hpp"
#include "bin_picking_perception/refinement/verification.hpp"

namespace bin_picking
{
void VerificationParameters::visit(ParameterVisitor& v)
{
  v.field({"enabled", "", "test poses against the depth grid; false: only the matching rate decides (the paper)"},
          enabled);
  v.field({"match_distance", "m", "distance threshold of the matching rate (Equation 9)", 1e-4, 0.1}, match_distance);
  v.field({"min_matching_rate", "", "smallest accepted matching rate", 0, 1}, min_matching_rate);
  v.field({"depth_tolerance", "", "distance to the surface that still explains a point, in leaves, noise not counted",
           0.0, 5},
          depth_tolerance);
  v.field({"noise_tolerance", "", "what is added to it, in standard deviations of the measured noise", 0, 20},
          noise_tolerance);
  v.field({"max_normal_angle", "rad", "a point whose normal is turned by more is not explained", 0.05, 3.2},
          max_normal_angle);
  v.field({"min_visible_fraction", "",
           "smallest explained share of the surface that faces the camera; less accepts parts "
           "that are hidden more",
           0, 1},
          min_visible_fraction);
  v.field(
      {"min_inlier_share", "", "smallest share of explained points among those that speak for or against a pose", 0, 1},
      min_inlier_share);
  v.field({"max_violation_share", "", "largest share of points behind which the sensor saw something", 0, 1},
          max_violation_share);
  v.field({"min_outline_share", "",
           "smallest share of the outline at which the scene ends, as it must around a part that lies "
           "free; parts packed side by side at one height need less",
           0, 1},
          min_outline_share);
  v.field(
      {"min_score", "", "smallest accepted probability that a pose is right; more returns fewer and surer ones", 0, 1},
      min_score);
  v.field({"unmeasured_weight", "",
           "how much a point without data speaks against a pose, compared to a contradicted one", 0, 1},
          unmeasured_weight);
  v.field({"min_turn_margin", "",
           "a pose is ambiguous if another one, turned so that most of the part looks the same, is "
           "contradicted by less than this more (half of it if its score is 0.96 or better), in squares of a leaf's "
           "edge; 0 accepts guesses",
           0, MOST_MARGIN},
          min_turn_margin);
  v.field({"accept_undetermined_turns", "",
           "return a pose whose turn about an axis cannot be told, if all else is known and what tells the turn is "
           "slight (training/slight_deviation), and say so; false: it is ambiguous, and rejected"},
          accept_undetermined_turns);
  v.field({"min_surface_share", "",
           "smallest share of the points measured near the part's surface that lie on it; parts of "
           "another shape leave points beside it",
           0, 1},
          min_surface_share);
  v.field(
      {"max_continued_share", "",
       "largest share of points that carry on the explained surface in front of the part, where the part itself ends "
       "or bends away; another part does that, rarely one that touches it flush",
       0, 1},
      max_continued_share);
  v.field({"max_bin_penetration", "m",
           "how deep a pose may reach through the floor or a wall of the given bin; as much as the "
           "bin's pose may be wrong",
           0, 1},
          max_bin_penetration);
  v.field({"overlap", "",
           "a detection that shares more than this part of its pixels with others is dropped, unless it explains more "
           "than they do",
           0.01, 1},
          overlap);
  v.field({"max_refined", "", "clusters that are refined and tested in full, best first", 1, 10000}, max_refined);
  v.field({"fruitless_rounds", "",
           "poses are refined in rounds of 8, most promising first; the search ends after so many rounds in a row of "
           "which nothing was accepted",
           1, 1000},
          fruitless_rounds);
}
}  // namespace bin_picking
