// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/training_parameters.hpp"

namespace bin_picking
{
void TrainingParameters::visit(ParameterVisitor& v)
{
  v.field({"leaf", "m",
           "voxel edge of the downsampling, from which radii and tolerances follow; 0 = 4 % of the diameter, at most "
           "6 mm or 1.5 %",
           0, 0.1},
          leaf);
  v.field(
      {"matching_leaf", "m",
       "voxel edge of the points that vote; 0 = 5 % of the diameter, at least the leaf. Voting time grows with about "
       "its -8th power",
       0, 0.1},
      matching_leaf);
  v.field({"surface_spacing", "m",
           "distance of the finer surface points for verification and refinement; 0 = half the leaf", 0, 0.05},
          surface_spacing);
  v.field({"seed", "", "seed of the surface sampling; the same seed gives the same model", 0, 2147483647}, seed);
  v.field({"normal_radius", "m", "radius of the plane fit for normals, on part and scene; 0 = 1.3 leaf", 0, 0.2},
          normal_radius);
  v.field({"feature", "",
           "Equation 5 with all six dimensions, weighted by Equation 8 or not, or its first four; auto: cur_ppf where "
           "views of the part repeat its curvature well enough to sort by it, otherwise ppf"},
          feature,
          {{"ppf", FeatureKind::Ppf},
           {"cur_ppf_unweighted", FeatureKind::CurPpfUnweighted},
           {"cur_ppf", FeatureKind::CurPpf},
           {"auto", FeatureKind::Auto}});
  v.field(
      {"curvature_measure", "",
       "Equation 4 (1/m, signed), or the variance of the normals that the published constants fit"},
      curvature_measure,
      {{"mean_curvature", CurvatureMeasure::MeanCurvature}, {"normal_variation", CurvatureMeasure::NormalVariation}});
  v.field({"curvature_radius", "m", "neighbourhood of the curvature, on part and scene; 0 = 3.3 leaf", 0, 0.5},
          curvature_radius);
  v.field(
      {"curvature_in_views", "",
       "take the curvature of a mesh from rendered views, as scenes show it; otherwise all around, as in the paper"},
      curvature_in_views);
  v.field({"d_dist", "m", "step of the distance in the feature; 0 = 0.6 matching_leaf", 0, 0.1}, d_dist);
  v.field({"d_angle", "rad", "step of the three angles in the feature, and of alpha in the accumulator", 0.02, 1.0},
          d_angle);
  v.field({"d_cur", "1/m or none",
           "step of the curvatures in the feature, in the unit of the measure; 0 = from the part", 0, 1e5},
          d_cur);
  v.field({"low_curvature_max", "1/m or none",
           "upper end of the low-curvature range of Equation 8; 0 with high = automatic", 0, 1e5},
          low_curvature_max);
  v.field({"high_curvature_min", "1/m or none",
           "lower end of the high-curvature range of Equation 8; 0 with low = automatic", 0, 1e5},
          high_curvature_min);
  v.field({"min_pair_distance", "m", "nearer pairs are not stored: their features say little; 0 = 1.5 matching_leaf", 0,
           0.2},
          min_pair_distance);
  v.field({"covisible_pairs", "", "store only pairs of points that one camera can see together"}, covisible_pairs);
  v.field(
      {"edge_pairs", "",
       "store also pairs of a surface point and a point where a face ends, for voting/edge_weight; a point model has "
       "none"},
      edge_pairs);
  v.field({"fold_symmetry", "", "of points that are symmetric images of each other one is the reference of pairs"},
          fold_symmetry);
  v.field({"num_views", "", "directions from which the part is rendered", 12, 4096}, num_views);
  v.field(
      {"slight_deviation", "",
       "a turn that moves the surface by at most this share of the diameter (twice, if that is no more than 6 % of "
       "the surface) is slight: where what tells it is not seen, the pose is returned with that turn left open, else "
       "it is ambiguous; 0: no turn is slight",
       0, 0.5},
      slight_deviation);
}
}  // namespace bin_picking
