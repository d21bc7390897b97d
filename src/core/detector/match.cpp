// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/refinement/icp.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"
#include "stages.hpp"

namespace bin_picking
{
namespace
{
/// Indices of scene points inside the part's bounding box, grown by `margin`, at a pose.
std::vector<int> inBox(const OrientedPoints& scene, const TrainedModel& model, const Pose& T_camera_object,
                       double margin)
{
  const Eigen::Isometry3f T_object_camera = T_camera_object.inverse().cast<float>();
  const Eigen::Vector3f center = model.center.cast<float>();
  const Eigen::Vector3f half = (model.size / 2).cast<float>() + Eigen::Vector3f::Constant(static_cast<float>(margin));
  std::vector<int> inside;
  for (std::size_t i = 0; i < scene.size(); ++i)
    if (((T_object_camera * scene.points[i] - center).cwiseAbs() - half).maxCoeff() <= 0)
      inside.push_back(static_cast<int>(i));
  return inside;
}

/// Evenly as many as refinement needs of what lies around the part.
MeasuredPart pointsNear(const OrientedPoints& scene, const TrainedModel& model, const Pose& T_camera_object)
{
  constexpr std::size_t ICP_POINTS = 600;
  const std::vector<int> inside = inBox(scene, model, T_camera_object, static_cast<double>(model.field.band()));
  const std::size_t step = std::max<std::size_t>(1, inside.size() / ICP_POINTS);
  std::vector<int> chosen;
  for (std::size_t k = 0; k < inside.size(); k += step)
    chosen.push_back(inside[k]);
  return {select(scene, chosen), {}};
}

/// What poses are held against.
struct PointScene
{
  const TrainedModel& model;
  const KdTree& surface;        ///< of the model
  const MeasuredPart samples;   ///< as far apart as the points of the model
  const OrientedPoints& dense;  ///< all that was given
  bool is_part;                 ///< and nothing else
};

/// Half of the iterations, with few points: enough to see which poses are worth more. The nearest neighbours of the
/// paper take all.
IcpResult refineRoughly(const Pose& T_camera_object, const PointScene& scene, IcpParameters icp)
{
  const TrainedModel& model = scene.model;
  if (icp.method == IcpMethod::PointToPoint)
    return icpPointToPoint(scene.surface, scene.samples.surface, T_camera_object,
                           icp.max_distance * model.parameters.leaf, icp);
  icp.max_iterations = (icp.max_iterations + 1) / 2;
  return icpDistanceField(model, scene.samples, T_camera_object, icp);
}

/// The other half, with all points and a narrow gate.
IcpResult polish(const Pose& T_camera_object, const PointScene& scene, IcpParameters icp)
{
  icp.max_iterations /= 2;
  icp.max_distance = icp.min_distance;
  return icpDistanceField(scene.model, pointsNear(scene.dense, scene.model, T_camera_object), T_camera_object, icp);
}

/// What the points say of the pose.
void rate(Detection& detection, const PointScene& scene, const VerificationParameters& parameters)
{
  const OrientedPoints& samples = scene.samples.surface;
  const double distance = parameters.match_distance;
  const auto object_points =
      scene.is_part ? samples.points
                    : select(samples, inBox(samples, scene.model, detection.T_camera_object, distance)).points;
  detection.matching_rate = matchingRate(scene.surface, detection.T_camera_object, object_points, distance);
  // Without a camera nothing says what should be seen: half of the part, as in a scan from one side, counts as all.
  const double matched = detection.matching_rate * static_cast<double>(object_points.size());
  detection.visible_fraction = std::min(1.0, matched / (0.5 * static_cast<double>(scene.model.points.size())));
  detection.score = detection.matching_rate * std::sqrt(detection.visible_fraction);
  detection.criteria = {{"matching_rate", detection.matching_rate, parameters.min_matching_rate, false}};
  detection.rejection = detection.criteria.front().passed() ? "" : failureText(detection.criteria.front());
}

Detection assess(const Hypothetical& pose, const PointScene& scene, const DetectorParameters& parameters)
{
  Detection detection;
  detection.part = scene.model.name;
  detection.votes = pose.votes;
  detection.T_camera_object = pose.T_camera_object;
  detection.rms = std::numeric_limits<double>::quiet_NaN();  // without ICP nothing was fitted
  if (parameters.icp.method != IcpMethod::None)
  {
    const IcpResult refined = refineRoughly(pose.T_camera_object, scene, parameters.icp);
    detection.T_camera_object = refined.T_camera_object;
    detection.rms = refined.rms;
  }
  rate(detection, scene, parameters.verification);
  return detection;
}

void sortByScore(std::vector<Detection>& detections)
{
  std::stable_sort(detections.begin(), detections.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
}

/// The best poses, best first.
std::vector<Detection> refineAndRate(const std::vector<Hypothetical>& poses, const PointScene& scene,
                                     const DetectorParameters& parameters, const Executor& executor)
{
  constexpr std::size_t MAX_REFINED = 10;
  constexpr std::size_t MAX_POLISHED = 3;
  std::vector<Detection> detections(std::min(poses.size(), MAX_REFINED));
  executor.forEach(detections.size(), [&](std::size_t i) { detections[i] = assess(poses[i], scene, parameters); });
  sortByScore(detections);
  if (parameters.icp.method != IcpMethod::DistanceField)
    return detections;
  executor.forEach(std::min(detections.size(), MAX_POLISHED), [&](std::size_t i) {
    const IcpResult polished = polish(detections[i].T_camera_object, scene, parameters.icp);
    detections[i].T_camera_object = polished.T_camera_object;
    detections[i].rms = polished.rms;
    rate(detections[i], scene, parameters.verification);
  });
  sortByScore(detections);
  return detections;
}
}  // namespace

DetectionResult Detector::match(const OrientedPoints& scene, bool scene_is_part) const
{
  if (models_.size() != 1)
    throw ParameterError("matching a point set takes one model, but the detector holds " +
                         std::to_string(models_.size()));
  if (scene.empty())
    throw CloudError(CloudFault::Empty, "the point set to be searched holds no points");
  const TrainedModel& model = *models_.front();
  const TrainingParameters& trained = model.parameters;
  const Deadline deadline(parameters_.deadline);
  DetectionResult result;
  StageClock clock(result);

  SearchRegion region;
  static_cast<OrientedPoints&>(region.samples) = resampleSurface(
      scene, {trained.matching_leaf, trained.normal_radius, trained.curvature_measure, trained.curvature_radius},
      executor_);
  region.references.resize(region.samples.size());
  for (std::size_t i = 0; i < region.references.size(); ++i)
    region.references[i] = static_cast<int>(i);
  region.references = chooseReferences(region.references, parameters_.voting);
  region.keep_clusters = parameters_.clustering.max_clusters;
  clock.count("samples", static_cast<double>(region.samples.size()));
  clock.lap("sampling");

  std::vector<SearchRegion> regions;
  regions.push_back(std::move(region));
  const auto poses = searchPoses(regions, nullptr, model, parameters_, deadline, executor_, clock, result.partial);
  const PointScene searched{model, *surfaces_.front(), {regions.front().samples, {}}, scene, scene_is_part};
  std::vector<Detection> detections = refineAndRate(poses, searched, parameters_, executor_);
  clock.lap("refinement");
  for (auto& detection : detections)
    (detection.rejection.empty() ? result.detections : result.rejected).push_back(std::move(detection));
  summarize(result);
  clock.finish();
  return result;
}
}  // namespace bin_picking
