// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/matching/voting.hpp"

namespace bin_picking
{
struct ClusteringParameters
{
  double distance = 0.1;  // of the diameter
  double angle = 0.35;    // rad
  int poses_per_reference = 3;
  int max_clusters = 600;
  double promising_share = 0.5;

  void visit(ParameterVisitor& v);
};

/// Hypotheses that agree, and their mean.
struct PoseCluster
{
  Pose T_camera_object = Pose::Identity();
  double votes = 0;  ///< sum over its hypotheses
  int members = 0;
};

/// Section 2.2.4: greedy grouping around the strongest hypotheses, modulo the part's symmetry; translations are
/// compared at the part's centre. The mean is taken over translation and (quaternion) rotation, weighted by votes.
/// Strongest first; the order is total (votes, then reference, then model point), so that it does not depend on
/// threads.
std::vector<PoseCluster> clusterPoses(std::vector<Hypothesis> hypotheses, const TrainedModel& model,
                                      const ClusteringParameters& parameters);

/// Vote-weighted mean of poses that lie close together: arithmetic mean of the positions of `center`, principal
/// eigenvector of the quaternions' outer products (Markley et al. 2007). Always a rigid motion.
Pose averagePoses(const std::vector<Pose>& poses, const std::vector<double>& weights, const Eigen::Vector3d& center);
}  // namespace bin_picking
