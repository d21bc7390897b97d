// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/scene_judgement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "rigid_pose.hpp"

namespace bin_picking
{
namespace
{
/// Middles farther apart than so many diameters: every distance of the two poses exceeds the diameter, and is not
/// computed.
constexpr double FAR_APART = 3;
constexpr double INFINITE = std::numeric_limits<double>::infinity();

double middleDistance(const PartShape& shape, const Pose& a, const Pose& b)
{
  return (a * shape.center - b * shape.center).norm();
}

/// Of the poses that an estimate claims to be one of (symmetry, and a turn that it leaves open), the one nearest to the
/// truth in rotation.
Pose nearestClaimed(const PartShape& shape, const PoseEstimate& estimate, const Pose& truth)
{
  return estimate.undetermined_turn
             ? nearestTurned(estimate.T_camera_object, truth, *estimate.undetermined_turn, shape.symmetry)
             : nearestEquivalent(estimate.T_camera_object, truth, shape.symmetry);
}

/// Mean distance from the true surface to the estimated one. Symmetry is undone first, so that the finite spacing of
/// the points adds nothing for a pose that is right.
double meanDistance(const PartShape& shape, const PoseEstimate& estimate, const Pose& truth)
{
  return averageNearestDistance(shape.surface_points, nearestClaimed(shape, estimate, truth), truth);
}

double largestDistanceOf(const PartShape& shape, const PoseEstimate& estimate, const Pose& truth)
{
  const auto& points = shape.extreme_points;
  return estimate.undetermined_turn
             ? maximumSymmetryAwareDistance(points, estimate.T_camera_object, truth, shape.symmetry,
                                            *estimate.undetermined_turn)
             : maximumSymmetryAwareDistance(points, estimate.T_camera_object, truth, shape.symmetry);
}

void requireEstimate(const EvaluationScene& scene, const PoseEstimate& estimate)
{
  const std::string what = "An estimate of '" + estimate.part + "' in scene " + scene.name;
  const std::string fault = rigidityFault(estimate.T_camera_object.linear(), estimate.T_camera_object.translation());
  if (!fault.empty())
    throw ParameterError(what + " " + fault + ".");
  if (std::isnan(estimate.score))
    throw ParameterError(what + " has a score that is not a number, so that it has no rank; give it one.");
  if (std::find(scene.parts.begin(), scene.parts.end(), estimate.part) == scene.parts.end())
    throw ParameterError(what + " is of a part that the scene does not search for; leave it out.");
}

void requireInstance(const EvaluationScene& scene, const TrueInstance& instance)
{
  if (std::isnan(instance.visible_fraction))
    throw ParameterError("An instance of '" + instance.part + "' in scene " + scene.name +
                         " has no visible fraction; estimate it from the scan first.");
}

using PoseDistance = double (*)(const PartShape&, const PoseEstimate&, const Pose&);

/// Row: estimate, column: instance; infinite for another part and for what is far apart.
Eigen::MatrixXd errorTable(const JudgedScene& judged, const PartShapes& shapes, PoseDistance distance)
{
  const auto& instances = judged.scene.instances;
  Eigen::MatrixXd errors = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(judged.estimates.size()),
                                                     static_cast<Eigen::Index>(instances.size()), INFINITE);
  for (std::size_t e = 0; e < judged.estimates.size(); ++e)
    for (std::size_t i = 0; i < instances.size(); ++i)
    {
      const PoseEstimate& estimate = judged.estimates[e].estimate;
      if (estimate.part != instances[i].part)
        continue;
      const PartShape& shape = shapes.at(estimate.part);
      const Pose& truth = instances[i].T_camera_object;
      if (middleDistance(shape, estimate.T_camera_object, truth) < FAR_APART * shape.diameter)
        errors(static_cast<Eigen::Index>(e), static_cast<Eigen::Index>(i)) = distance(shape, estimate, truth);
    }
  return errors;
}

PoseEstimate estimateOf(const Detection& detection)
{
  return {detection.part, detection.T_camera_object, detection.score, detection.undetermined_turn};
}

bool hitsAny(const PoseEstimate& estimate, const std::vector<TrueInstance>& instances, const PartShape& shape,
             double limit)
{
  return std::any_of(instances.begin(), instances.end(), [&](const TrueInstance& instance) {
    return instance.part == estimate.part &&
           middleDistance(shape, estimate.T_camera_object, instance.T_camera_object) < FAR_APART * shape.diameter &&
           largestDistanceOf(shape, estimate, instance.T_camera_object) < limit;
  });
}

/// The column of the smallest entry of a row that is below the limit.
std::optional<std::size_t> nearestBelow(const Eigen::MatrixXd& errors, std::size_t row, double limit)
{
  std::optional<std::size_t> nearest;
  for (Eigen::Index column = 0; column < errors.cols(); ++column)
    if (const double error = errors(static_cast<Eigen::Index>(row), column); error < limit)
    {
      limit = error;
      nearest = static_cast<std::size_t>(column);
    }
  return nearest;
}

/// The instance of the same part whose middle is nearest, within half a diameter.
std::optional<std::size_t> neighbour(const PoseEstimate& estimate, const std::vector<TrueInstance>& instances,
                                     const PartShape& shape)
{
  std::optional<std::size_t> nearest;
  double limit = shape.diameter / 2;
  for (std::size_t i = 0; i < instances.size(); ++i)
  {
    const double distance = middleDistance(shape, estimate.T_camera_object, instances[i].T_camera_object);
    if (instances[i].part == estimate.part && distance < limit)
    {
      limit = distance;
      nearest = i;
    }
  }
  return nearest;
}

void measureErrors(JudgedEstimate& judged, const std::vector<TrueInstance>& instances, const PartShape& shape)
{
  if (!judged.instance)
    return;
  const PoseEstimate& estimate = judged.estimate;
  const Pose& truth = instances[*judged.instance].T_camera_object;
  judged.error = poseError(nearestClaimed(shape, estimate, truth), truth, Symmetry(), shape.center);
  judged.max_distance = largestDistanceOf(shape, estimate, truth);
  judged.mean_distance = meanDistance(shape, estimate, truth);
}

std::vector<JudgedEstimate> bestFirst(const std::vector<PoseEstimate>& estimates)
{
  std::vector<JudgedEstimate> sorted;
  for (const PoseEstimate& estimate : estimates)
  {
    sorted.emplace_back();
    sorted.back().estimate = estimate;
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](const JudgedEstimate& a, const JudgedEstimate& b) {
    return a.estimate.score > b.estimate.score;
  });
  return sorted;
}

/// \param errors MSSD
void passVerdicts(JudgedScene& judged, const Eigen::MatrixXd& errors, const std::vector<double>& limits,
                  double lowest_level)
{
  const auto& instances = judged.scene.instances;
  const auto hits = assignGreedily(errors, limits);
  judged.found_by.resize(instances.size());
  for (std::size_t e = 0; e < hits.size(); ++e)
  {
    JudgedEstimate& estimate = judged.estimates[e];
    estimate.instance = hits[e] ? hits[e] : nearestBelow(errors, e, limits[e]);
    if (!estimate.instance)
      continue;
    if (hits[e])
      judged.found_by[*hits[e]] = e;
    const bool is_hidden = instances[*estimate.instance].visible_fraction < lowest_level;
    estimate.verdict = !hits[e] ? Verdict::Duplicate : is_hidden ? Verdict::Hidden : Verdict::Right;
  }
}

std::string errorText(const PoseError& error, int digits)
{
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f mm, %.*f deg", digits, error.translation * 1000, digits,
                error.rotation * 180 / M_PI);
  return text.data();
}
}  // namespace

void EvaluationParameters::visit(ParameterVisitor& v)
{
  v.field({"max_error_share", "",
           "a pose is right if no point of the part is off by more than this share of its diameter; "
           "larger accepts coarser poses",
           0.001, 1},
          max_error_share);
  v.field({"visible_levels", "",
           "visible fractions from which on instances have to be found, each with its own recall; below "
           "the lowest one nobody asks for them"},
          visible_levels, std::vector<std::string>());
}

std::vector<double> EvaluationParameters::levels() const
{
  std::istringstream words(visible_levels);
  words.imbue(std::locale::classic());
  std::vector<double> numbers;
  for (double level = 0; words >> level;)
    numbers.push_back(level);
  std::sort(numbers.begin(), numbers.end());
  if (!words.eof() || numbers.empty() || !(numbers.front() > 0 && numbers.back() <= 1))
    throw ParameterError("visible_levels is '" + visible_levels +
                         "', but it must be numbers in (0, 1] with spaces between them, for example '0.5 0.85'.");
  return numbers;
}

std::vector<std::optional<std::size_t>> assignGreedily(const Eigen::MatrixXd& errors, const std::vector<double>& limits)
{
  Eigen::MatrixXd left = errors;
  std::vector<std::optional<std::size_t>> assigned;
  for (std::size_t row = 0; row < limits.size(); ++row)
  {
    assigned.push_back(nearestBelow(left, row, limits[row]));
    if (assigned.back())
      left.col(static_cast<Eigen::Index>(*assigned.back())).setConstant(INFINITE);
  }
  return assigned;
}

JudgedScene judgeScene(const EvaluationScene& scene, const std::vector<PoseEstimate>& estimates,
                       const PartShapes& shapes, const EvaluationParameters& parameters)
{
  for (const PoseEstimate& estimate : estimates)
    requireEstimate(scene, estimate);
  for (const TrueInstance& instance : scene.instances)
    requireInstance(scene, instance);
  JudgedScene judged;
  judged.scene = scene;
  judged.estimates = bestFirst(estimates);
  std::vector<double> limits;
  for (const JudgedEstimate& e : judged.estimates)
    limits.push_back(parameters.max_error_share * shapes.at(e.estimate.part).diameter);
  judged.found_by_mean_distance.resize(scene.instances.size());
  for (const auto& hit : assignGreedily(errorTable(judged, shapes, meanDistance), limits))
    if (hit)
      judged.found_by_mean_distance[*hit] = true;
  passVerdicts(judged, errorTable(judged, shapes, largestDistanceOf), limits, parameters.levels().front());
  for (JudgedEstimate& e : judged.estimates)
  {
    const PartShape& shape = shapes.at(e.estimate.part);
    if (!e.instance)
      e.instance = neighbour(e.estimate, scene.instances, shape);
    measureErrors(e, scene.instances, shape);
  }
  return judged;
}

std::vector<TestedPose> judgeTested(const EvaluationScene& scene, const DetectionResult& result,
                                    const PartShapes& shapes, const EvaluationParameters& parameters)
{
  std::vector<TestedPose> tested;
  for (const auto* poses : {&result.detections, &result.rejected})
    for (const Detection& detection : *poses)
    {
      if (!detection.quality)
        continue;
      const PartShape& shape = shapes.at(detection.part);
      tested.push_back(
          {detection.part, detection.score, *detection.quality, detection.rejection.empty(),
           hitsAny(estimateOf(detection), scene.instances, shape, parameters.max_error_share * shape.diameter)});
    }
  return tested;
}

const char* toString(Verdict verdict)
{
  switch (verdict)
  {
    case Verdict::Right:
      return "right";
    case Verdict::Hidden:
      return "hidden";
    case Verdict::Duplicate:
      return "duplicate";
    default:
      return "wrong";
  }
}

std::string verdictText(const JudgedScene& scene, std::size_t estimate)
{
  const JudgedEstimate& judged = scene.estimates.at(estimate);
  switch (judged.verdict)
  {
    case Verdict::Right:
      return (judged.estimate.undetermined_turn ? "right up to its turn: " : "right: ") + errorText(judged.error, 2);
    case Verdict::Hidden:
      return "right, but hidden: " + errorText(judged.error, 2);
    case Verdict::Duplicate:
      return "duplicate of #" + std::to_string(scene.found_by.at(*judged.instance).value() + 1);
    default:
      return judged.instance ? "off by " + errorText(judged.error, 1) : "no part there";
  }
}
}  // namespace bin_picking
