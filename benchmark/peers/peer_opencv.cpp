// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <opencv2/surface_matching.hpp>

#include "peer_data.hpp"

namespace bin_picking::peers
{
namespace
{
namespace ppf = cv::ppf_match_3d;

/// OpenCV's thresholds are numbers made for millimetres.
constexpr double MILLIMETRES = 1000;
constexpr double ICP_MARGIN = 0.05;  // of the diameter, around the part
constexpr int MIN_ICP_POINTS = 50;   // with fewer its least squares are not determined

cv::Mat toMat(const OrientedPoints& points)
{
  cv::Mat mat(static_cast<int>(points.size()), 6, CV_32F);
  for (int i = 0; i < mat.rows; ++i)
    for (int k = 0; k < 3; ++k)
    {
      mat.at<float>(i, k) = static_cast<float>(MILLIMETRES) * points.points[static_cast<std::size_t>(i)][k];
      mat.at<float>(i, k + 3) = points.normals[static_cast<std::size_t>(i)][k];
    }
  return mat;
}

std::optional<Pose> toPose(const cv::Matx44d& matrix)
{
  Eigen::Matrix4d metres;
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c)
      metres(r, c) = matrix(r, c);
  metres.topRightCorner<3, 1>() /= MILLIMETRES;
  return nearestRigid(metres);
}

double diagonalOf(const OrientedPoints& points) { return boundingBoxDiagonal(points.points); }

/// Sampled in cubes beforehand: OpenCV's own cells have the proportions of the bounding box, so that an object gives
/// other points in every attitude. Their shares are of the box's diagonal, the model's and the scene's in turn; ours
/// make both distances the same number of metres.
class OpenCv : public Peer
{
public:
  void train(const PeerModel& model, double step) override
  {
    cv::setNumThreads(1);
    model_ = model;
    edge_ = step * model.diameter;
    const OrientedPoints sampled = sampledInCubes(model.surface, edge_);
    model_points_ = static_cast<int>(sampled.size());
    const double share = edge_ / diagonalOf(sampled);
    detector_ = std::make_unique<ppf::PPF3DDetector>(share, share, 30);
    // The defaults cluster poses within 0.05 mm, that is, none.
    detector_->setSearchParams(0.05 * model.diameter * MILLIMETRES, 12 * CV_PI / 180, true);
    detector_->trainModel(toMat(sampled));
  }

  PeerResult find(const PeerScene& scene) override
  {
    const OrientedPoints sampled = sampledInCubes(scene.points, edge_);
    const cv::Mat points = toMat(sampled);
    PeerResult result;
    result.scene_points = static_cast<int>(sampled.size());
    std::vector<ppf::Pose3DPtr> found;
    const double start = cpuSeconds();
    detector_->match(points, found, 1.0 / 5.0, edge_ / diagonalOf(sampled));
    result.match_seconds = cpuSeconds() - start;
    for (const ppf::Pose3DPtr& candidate : found)
    {
      const std::optional<Pose> pose = toPose(candidate->pose);
      if (pose && static_cast<int>(result.matched.size()) < scene.max_poses)
        result.matched.push_back({*pose, static_cast<double>(candidate->numVotes)});
    }
    for (const PeerPose& matched : result.matched)
      result.poses.push_back({refine(matched.T_camera_object, scene, result.icp_seconds), matched.score});
    return result;
  }

  int modelPoints() const override { return model_points_; }
  bool verifies() const override { return false; }

private:
  Pose refine(const Pose& T_camera_object, const PeerScene& scene, double& seconds) const
  {
    const OrientedPoints seen = seenPoints(model_, model_.surface, T_camera_object);
    const cv::Mat source = toMat(transformed(seen, T_camera_object));
    const cv::Mat target = toMat(nearPose(scene.fine, model_, T_camera_object, ICP_MARGIN * model_.diameter));
    if (std::min(source.rows, target.rows) < MIN_ICP_POINTS)
      return T_camera_object;
    double residual = 0;
    cv::Matx44d moved = cv::Matx44d::eye();
    const double start = cpuSeconds();
    ppf::ICP(100, 0.005f, 2.5f, 8).registerModelToScene(source, target, residual, moved);
    seconds += cpuSeconds() - start;
    const std::optional<Pose> T_moved = toPose(moved);
    return T_moved ? *T_moved * T_camera_object : T_camera_object;
  }

  PeerModel model_;
  double edge_ = 0;  // of the cubes, metres
  int model_points_ = 0;
  std::unique_ptr<ppf::PPF3DDetector> detector_;
};
}  // namespace

std::unique_ptr<Peer> makeOpenCv() { return std::make_unique<OpenCv>(); }
}  // namespace bin_picking::peers
