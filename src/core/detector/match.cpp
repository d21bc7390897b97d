// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/refinement/icp.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"
#include "same_place.hpp"
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
void rate(Detection& detection, const PointScene& scene, const DetectorParameters& parameters)
{
  const OrientedPoints& samples = scene.samples.surface;
  const double distance = parameters.verification.match_distance;
  const auto object_points =
      scene.is_part ? samples.points
                    : select(samples, inBox(samples, scene.model, detection.T_camera_object, distance)).points;
  // The field costs a fraction of a search, but knows no distance beyond its band.
  detection.matching_rate = parameters.icp.method == IcpMethod::DistanceField && distance < scene.model.field.band()
                                ? matchingRate(scene.model.field, detection.T_camera_object, object_points, distance)
                                : matchingRate(scene.surface, detection.T_camera_object, object_points, distance);
  // Without a camera nothing says what should be seen: half of the part, as in a scan from one side, counts as all.
  const double matched = detection.matching_rate * static_cast<double>(object_points.size());
  detection.visible_fraction = std::min(1.0, matched / (0.5 * static_cast<double>(scene.model.points.size())));
  detection.score = detection.matching_rate * std::sqrt(detection.visible_fraction);
  detection.criteria = {{"matching_rate", detection.matching_rate, parameters.verification.min_matching_rate, false}};
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
  rate(detection, scene, parameters);
  return detection;
}

/// Best first. What the matching rate does not see, a feature lower than its distance, the residuals do.
void sortByScore(std::vector<Detection>& detections)
{
  const auto residual = [](const Detection& one) {
    return std::isnan(one.rms) ? std::numeric_limits<double>::infinity() : one.rms;
  };
  std::stable_sort(detections.begin(), detections.end(), [&](const Detection& a, const Detection& b) {
    return a.score > b.score || (a.score == b.score && residual(a) < residual(b));
  });
}

/// Of poses that were led to one place the best stays. \return how many were led where the best was
std::size_t dropRepeated(std::vector<Detection>& best_first, const TrainedModel& model)
{
  const SamePlace same_place(model, Turns::None);
  std::vector<Place> places;
  std::size_t at_best = 0;
  const auto is_repeated = [&](const Detection& detection) {
    const Place place = same_place.of(detection.T_camera_object);
    at_best += places.empty() || same_place(places.front(), place);
    const bool repeated = same_place.isAmong(places, place);
    if (!repeated)
      places.push_back(place);
    return repeated;
  };
  best_first.erase(std::remove_if(best_first.begin(), best_first.end(), is_repeated), best_first.end());
  return at_best;
}

/// Some at a time, until one place that explains nearly all was reached from several: more would lead there again.
std::vector<Detection> refineSome(const std::vector<Hypothetical>& poses, const PointScene& scene,
                                  const DetectorParameters& parameters, const Executor& executor, StageClock& clock)
{
  constexpr std::size_t MAX_REFINED = 10;
  constexpr std::size_t ROUND = 4;  // whatever the number of threads, as the result depends on it
  constexpr std::size_t AGREEING = 2;
  constexpr double NEARLY_ALL = 0.98;
  const std::size_t most = std::min(poses.size(), MAX_REFINED);
  std::vector<Detection> refined;
  std::vector<Detection> detections;
  bool is_settled = false;
  while (refined.size() < most && !is_settled)
  {
    const std::size_t begin = refined.size();
    refined.resize(std::min(begin + ROUND, most));
    executor.forEach(refined.size() - begin,
                     [&](std::size_t i) { refined[begin + i] = assess(poses[begin + i], scene, parameters); });
    detections = refined;
    sortByScore(detections);
    const bool agree = dropRepeated(detections, scene.model) >= AGREEING;
    // The paper refines every candidate.
    is_settled = parameters.verification.enabled && agree && detections.front().matching_rate > NEARLY_ALL;
  }
  clock.count("refined", static_cast<double>(refined.size()));
  return detections;
}

/// The best poses, best first.
std::vector<Detection> refineAndRate(const std::vector<Hypothetical>& poses, const PointScene& scene,
                                     const DetectorParameters& parameters, const Executor& executor, StageClock& clock)
{
  constexpr std::size_t MAX_POLISHED = 3;
  std::vector<Detection> detections = refineSome(poses, scene, parameters, executor, clock);
  if (parameters.icp.method != IcpMethod::DistanceField)
    return detections;
  executor.forEach(std::min(detections.size(), MAX_POLISHED), [&](std::size_t i) {
    const IcpResult polished = polish(detections[i].T_camera_object, scene, parameters.icp);
    detections[i].T_camera_object = polished.T_camera_object;
    detections[i].rms = polished.rms;
    rate(detections[i], scene, parameters);
  });
  sortByScore(detections);
  return detections;
}
}  // namespace

namespace
{
void requireUsable(const OrientedPoints& scene)
{
  if (scene.empty())
    throw CloudError(CloudFault::Empty, "the point set to be searched holds no points");
  if (scene.normals.size() != scene.size())
    throw ParameterError("the point set to be searched holds " + std::to_string(scene.size()) + " points but " +
                         std::to_string(scene.normals.size()) + " normals; give each point one");
  for (std::size_t i = 0; i < scene.size(); ++i)
    if (!scene.points[i].allFinite() || !scene.normals[i].allFinite())
      throw ParameterError("point " + std::to_string(i) +
                           " of the set to be searched, or its normal, is not finite; leave out what was not measured");
}
}  // namespace

DetectionResult Detector::match(const OrientedPoints& scene, bool scene_is_part) const
{
  if (models_.size() != 1)
    throw ParameterError("matching a point set takes one model, but the detector holds " +
                         std::to_string(models_.size()));
  requireUsable(scene);
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
  std::vector<Detection> detections = refineAndRate(poses, searched, parameters_, executor_, clock);
  clock.lap("refinement");
  for (auto& detection : detections)
    (detection.rejection.empty() ? result.detections : result.rejected).push_back(std::move(detection));
  summarize(result);
  clock.finish();
  return result;
}
}  // namespace bin_picking
