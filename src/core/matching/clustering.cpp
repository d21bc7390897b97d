// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/matching/clustering.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <tuple>

namespace bin_picking
{
void ClusteringParameters::visit(ParameterVisitor& v)
{
  v.field({"distance", "", "poses nearer than this share of the diameter (at the part's centre) may be one", 0.001, 1},
          distance);
  v.field({"angle", "rad", "poses turned by less than this may be one", 0.01, 3.2}, angle);
  v.field({"poses_per_reference", "",
           "poses of each reference point that are grouped: those that a glance at the scene contradicts least; more "
           "find more hidden parts and cost time",
           1, 20},
          poses_per_reference);
  v.field({"max_clusters", "",
           "strongest clusters that are looked at further; more find more hidden parts and cost time", 1, 100000},
          max_clusters);
  v.field({"promising_share", "",
           "share of the clusters, those that a glance at the scene contradicts least, that are ranked; more find "
           "more hidden parts and cost time",
           0.01, 1},
          promising_share);
}

namespace
{
struct Cluster
{
  Pose leader;
  std::vector<Pose> poses;
  std::vector<double> weights;
  double votes = 0;
};

/// Strongest first, in an order that no two hypotheses share.
void sortByStrength(std::vector<Hypothesis>& hypotheses)
{
  std::sort(hypotheses.begin(), hypotheses.end(), [](const Hypothesis& a, const Hypothesis& b) {
    return std::make_tuple(-a.votes, a.reference, a.model_point) <
           std::make_tuple(-b.votes, b.reference, b.model_point);
  });
}

/// Clusters in the order in which they were opened.
struct Clusters
{
  std::vector<Cluster> all;
  std::vector<Eigen::Vector3d> centers;  ///< of the part at the leaders' poses: side by side, because all are looked at

  Cluster& open(const Pose& leader, const Eigen::Vector3d& center)
  {
    all.push_back({leader, {}, {}, 0});
    centers.push_back(center);
    return all.back();
  }
};

/// The first that the pose belongs to; nullptr if none. \param equivalent the pose as that cluster sees it
Cluster* findCluster(Clusters& clusters, const Pose& pose, const Eigen::Vector3d& center,
                     const ClusteringParameters& parameters, const TrainedModel& model, Pose& equivalent)
{
  const double squared_distance = std::pow(parameters.distance * model.diameter, 2);
  const double min_trace = 1 + 2 * std::cos(parameters.angle);  // of the turn from one to the other
  for (std::size_t k = 0; k < clusters.all.size(); ++k)
  {
    if ((clusters.centers[k] - center).squaredNorm() > squared_distance)
      continue;
    const Pose& leader = clusters.all[k].leader;
    equivalent = model.symmetry.trivial() ? pose : nearestEquivalent(pose, leader, model.symmetry);
    if (leader.linear().cwiseProduct(equivalent.linear()).sum() > min_trace)
      return &clusters.all[k];
  }
  return nullptr;
}
}  // namespace

Pose averagePoses(const std::vector<Pose>& poses, const std::vector<double>& weights, const Eigen::Vector3d& center)
{
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Matrix4d outer = Eigen::Matrix4d::Zero();
  double sum = 0;
  for (std::size_t i = 0; i < poses.size(); ++i)
  {
    const Eigen::Vector4d q = Eigen::Quaterniond(poses[i].linear()).coeffs();
    position += weights[i] * (poses[i] * center);
    outer += weights[i] * q * q.transpose();
    sum += weights[i];
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(outer);
  const Eigen::Vector4d q = solver.eigenvectors().col(3);
  Pose mean = Pose::Identity();
  mean.linear() = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix();
  mean.translation() = position / sum - mean.linear() * center;
  return mean;
}

std::vector<PoseCluster> clusterPoses(std::vector<Hypothesis> hypotheses, const TrainedModel& model,
                                      const ClusteringParameters& parameters)
{
  sortByStrength(hypotheses);
  Clusters opened;
  for (const auto& hypothesis : hypotheses)
  {
    const Pose& pose = hypothesis.T_camera_object;
    const Eigen::Vector3d center = pose * model.center;
    Pose equivalent = pose;
    Cluster* cluster = findCluster(opened, pose, center, parameters, model, equivalent);
    if (cluster == nullptr)
    {
      cluster = &opened.open(pose, center);
      equivalent = pose;
    }
    cluster->poses.push_back(equivalent);
    cluster->weights.push_back(hypothesis.votes);
    cluster->votes += hypothesis.votes;
  }
  std::vector<Cluster> clusters = std::move(opened.all);
  std::stable_sort(clusters.begin(), clusters.end(),
                   [](const Cluster& a, const Cluster& b) { return a.votes > b.votes; });

  const std::size_t kept = std::min(clusters.size(), static_cast<std::size_t>(parameters.max_clusters));
  std::vector<PoseCluster> result;
  result.reserve(kept);
  for (std::size_t i = 0; i < kept; ++i)
  {
    const Cluster& cluster = clusters[i];
    const bool alone = cluster.poses.size() == 1;  // as most are
    const Pose mean = alone ? cluster.leader : averagePoses(cluster.poses, cluster.weights, model.center);
    result.push_back({mean, cluster.votes, static_cast<int>(cluster.poses.size())});
  }
  return result;
}
}  // namespace bin_picking
