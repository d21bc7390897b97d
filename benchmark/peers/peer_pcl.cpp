// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <pcl/console/print.h>
#include <pcl/features/ppf.h>
#include <pcl/point_types.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/ppf_registration.h>

#include <algorithm>

#include "peer_data.hpp"

namespace bin_picking::peers
{
namespace
{
using Cloud = pcl::PointCloud<pcl::PointNormal>;

// Its features take the arc cosine of dot products, which float rounding lifts above 1 for parallel normals.
constexpr float NORMAL_SCALE = 0.999999f;
// Votes land in floor(2 pi / step) columns or one more, for which it has no memory: a step just below a whole fraction
// makes both the same.
constexpr float ANGLE_STEP = static_cast<float>(2 * M_PI / 31.0003);
constexpr double ICP_STEP = 0.02;      // of the diameter
constexpr double ICP_DISTANCE = 0.05;  // of the diameter
constexpr std::size_t MIN_ICP_POINTS = 50;
constexpr std::size_t MIN_SCENE_POINTS = 10;
constexpr int MAX_SEARCHES = 10;  // of one scan: each costs as much as the first

Cloud::Ptr toCloud(const OrientedPoints& points)
{
  Cloud::Ptr cloud(new Cloud);
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    pcl::PointNormal point;
    point.getVector3fMap() = points.points[i];
    point.getNormalVector3fMap() = NORMAL_SCALE * points.normals[i];
    cloud->push_back(point);
  }
  return cloud;
}

class Pcl : public Peer
{
public:
  void train(const PeerModel& model, double step) override
  {
    pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
    model_ = model;
    edge_ = step * model.diameter;
    sampled_ = toCloud(sampledInCubes(model.surface, edge_));
    icp_points_ = sampledInCubes(model.surface, ICP_STEP * model.diameter);
    pcl::PPFEstimation<pcl::PointNormal, pcl::PointNormal, pcl::PPFSignature> estimation;
    estimation.setInputCloud(sampled_);
    estimation.setInputNormals(sampled_);
    pcl::PointCloud<pcl::PPFSignature>::Ptr features(new pcl::PointCloud<pcl::PPFSignature>);
    estimation.compute(*features);
    table_.reset(new pcl::PPFHashMapSearch(ANGLE_STEP, static_cast<float>(edge_)));
    table_->setInputFeatureCloud(features);
  }

  /// It returns one pose; for more, what lies under it is taken away and the rest searched again.
  PeerResult find(const PeerScene& scene) override
  {
    PeerResult result;
    OrientedPoints left = sampledInCubes(scene.points, edge_);
    result.scene_points = static_cast<int>(left.size());
    const double start = cpuSeconds();
    const int wanted = std::min(scene.max_poses, MAX_SEARCHES);
    while (static_cast<int>(result.poses.size()) < wanted && left.size() >= MIN_SCENE_POINTS)
    {
      const std::optional<Pose> pose = match(toCloud(left), result.match_seconds);
      if (!pose)
        break;
      // A repeated search says nothing of how good a pose is, except that it came before the next one.
      const double score = -static_cast<double>(result.poses.size());
      result.matched.push_back({*pose, score});
      result.poses.push_back({refine(*pose, scene, result.icp_seconds), score});
      if (cpuSeconds() - start > scene.max_seconds)
        break;
      left = withoutPart(left, result.poses.back().T_camera_object);
    }
    return result;
  }

  int modelPoints() const override { return static_cast<int>(sampled_->size()); }
  bool verifies() const override { return false; }

private:
  std::optional<Pose> match(const Cloud::Ptr& points, double& seconds) const
  {
    pcl::PPFRegistration<pcl::PointNormal, pcl::PointNormal> registration;
    registration.setSceneReferencePointSamplingRate(5);
    registration.setPositionClusteringThreshold(static_cast<float>(0.1 * model_.diameter));
    registration.setRotationClusteringThreshold(static_cast<float>(12 * M_PI / 180));
    registration.setSearchMethod(table_);
    Cloud moved;
    const double start = cpuSeconds();
    registration.setInputSource(sampled_);
    registration.setInputTarget(points);
    registration.align(moved);
    seconds += cpuSeconds() - start;
    return nearestRigid(registration.getFinalTransformation().cast<double>());
  }

  Pose refine(const Pose& T_camera_object, const PeerScene& scene, double& seconds) const
  {
    const Cloud::Ptr source = toCloud(transformed(seenPoints(model_, icp_points_, T_camera_object), T_camera_object));
    const Cloud::Ptr target = toCloud(nearPose(scene.fine, model_, T_camera_object, ICP_DISTANCE * model_.diameter));
    if (std::min(source->size(), target->size()) < MIN_ICP_POINTS)
      return T_camera_object;
    pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal> icp;
    icp.setMaximumIterations(50);
    icp.setMaxCorrespondenceDistance(ICP_DISTANCE * model_.diameter);
    Cloud moved;
    const double start = cpuSeconds();
    icp.setInputSource(source);
    icp.setInputTarget(target);
    icp.align(moved);
    seconds += cpuSeconds() - start;
    const std::optional<Pose> T_moved = nearestRigid(icp.getFinalTransformation().cast<double>());
    return T_moved ? *T_moved * T_camera_object : T_camera_object;
  }

  OrientedPoints withoutPart(const OrientedPoints& points, const Pose& T_camera_object) const
  {
    const Pose T_object_camera = T_camera_object.inverse();
    const Eigen::Vector3d half = 0.5 * model_.size;
    std::vector<int> outside;
    for (std::size_t i = 0; i < points.size(); ++i)
      if (((T_object_camera * points.points[i].cast<double>() - model_.center).cwiseAbs() - half).maxCoeff() > 0)
        outside.push_back(static_cast<int>(i));
    return select(points, outside);
  }

  PeerModel model_;
  double edge_ = 0;  // of the cubes, metres
  Cloud::Ptr sampled_;
  OrientedPoints icp_points_;
  pcl::PPFHashMapSearch::Ptr table_;
};
}  // namespace

std::unique_ptr<Peer> makePcl() { return std::make_unique<Pcl>(); }
}  // namespace bin_picking::peers
