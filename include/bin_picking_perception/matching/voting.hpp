// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/common/deadline.hpp"
#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/model/trained_model.hpp"

namespace bin_picking
{
class Executor;

struct VotingParameters
{
  double reference_share = 0.03;
  int min_references = 8;
  double max_pair_distance = 0.7;
  int weight = 1;
  int edge_weight = 3;
  double curvature_spread = 0.3;
  bool curvature_wildcard = true;
  int max_bucket = 0;
  int max_votes = 30000;
  bool skip_repeated = true;
  int peaks_per_reference = 6;
  double min_peak_share = 0.4;
  bool sum_adjacent_angles = true;

  void visit(ParameterVisitor& v);
};

/// A pose from the accumulator of one reference point.
struct Hypothesis
{
  Pose T_camera_object = Pose::Identity();
  double votes = 0;
  int reference = 0;    ///< scene sample
  int model_point = 0;  ///< into TrainedModel::points
};

struct VotingStatistics
{
  std::uint64_t references = 0;
  std::uint64_t pairs = 0;  ///< scene pairs looked up
  std::uint64_t votes = 0;
};

struct VotingResult
{
  std::vector<Hypothesis> hypotheses;  ///< ordered by reference, then votes
  VotingStatistics statistics;
  bool partial = false;  ///< the deadline passed
};

/// Every n-th of `candidates`, so that about reference_share of them, but at least min_references, are drawn.
std::vector<int> chooseReferences(const std::vector<int>& candidates, const VotingParameters& parameters);

/// One point of every cube of a grid, the middle one in their order, so that small and hidden parts have their
/// references too. A cube's edge is `leaf`, the distance of the points, over the root of reference_share: of a plane
/// across the cubes that share is drawn, of broken surfaces more. Smaller cubes where they are fewer than
/// min_references.
std::vector<int> spreadReferences(const std::vector<Eigen::Vector3f>& points, double leaf,
                                  const VotingParameters& parameters);

/// Sections 2.2.2 and 2.2.3. For each reference point: Equation 5 with every sample within the part's diameter,
/// look-up, weighted votes (Equation 8) in the accumulator of model points x angle steps, and its peaks as poses
/// (Equation 6). The result does not depend on the number of threads. \param scene with curvature. Where it is NaN the
/// point takes part in four dimensions only: it meets every curvature bin \param curvature_complete per point; 0: the
/// neighbourhood was cut off, and with curvature_wildcard the curvature counts as
///   unknown. Empty: all are complete
/// \param edges edgePoints of the scene, at most one per matching leaf and direction; with edge_weight the reference
/// points pair with them too
VotingResult voteForPoses(const TrainedModel& model, const OrientedPoints& scene,
                          const std::vector<std::uint8_t>& curvature_complete, const OrientedPoints& edges,
                          const std::vector<int>& references, const VotingParameters& parameters,
                          const Deadline& deadline, const Executor& executor);
}  // namespace bin_picking
