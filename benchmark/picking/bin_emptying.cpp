// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_emptying.hpp"

#include <algorithm>
#include <chrono>

#include "bin_picking_perception/grasping/avoid_list.hpp"

namespace bin_picking::picking
{
namespace
{
using simulation::Body;
using simulation::CellScan;
using simulation::GripObstacle;
using simulation::GripStage;
using simulation::GripVerdict;
using simulation::VirtualCell;

// Of a cell at work: from one exposure to the next, and how long it waits where nothing is allowed. Seconds.
constexpr double CYCLE = 7;
constexpr double WAIT = 35;
constexpr double MIN_VISIBLE = 0.3;  // share of a part that is seen, from which on the truth counts as a detection

class Clock
{
public:
  double seconds() const { return std::chrono::duration<double>(Now::now() - start_).count(); }

private:
  using Now = std::chrono::steady_clock;
  Now::time_point start_ = Now::now();
};

/// The parts as they truly lie, where enough of them is seen.
std::vector<Detection> trueDetections(const CellScan& scan, const VirtualCell& cell, const Detector& detector)
{
  std::vector<Detection> detections;
  for (const simulation::CellInstance& instance : scan.instances)
  {
    if (instance.view.visible_fraction < MIN_VISIBLE)
      continue;
    Detection detection;
    detection.part = cell.parts()[static_cast<std::size_t>(instance.part)].name;
    while (detector.models()[detection.model_index]->name != detection.part)
      ++detection.model_index;
    detection.T_camera_object = instance.T_camera_object;
    detection.score = detection.visible_fraction = instance.view.visible_fraction;
    detection.matching_rate = 1;
    detections.push_back(detection);
  }
  std::stable_sort(detections.begin(), detections.end(),
                   [](const Detection& a, const Detection& b) { return a.score > b.score; });
  return detections;
}

/// As a cell would report it that knows what it holds: where a part was seen that is not there, none is looked for
/// again.
PickOutcome outcomeOf(const Attempt& attempt)
{
  if (attempt.another_part)
    return PickOutcome::Missed;
  switch (attempt.verdict.outcome)
  {
    case GripVerdict::Outcome::Taken:
      return PickOutcome::Picked;
    case GripVerdict::Outcome::Missed:
      return PickOutcome::Missed;
    case GripVerdict::Outcome::Collision:
      break;
  }
  return PickOutcome::Collision;
}

/// The emptying of one bin.
class Session
{
public:
  Session(VirtualCell& cell, std::uint32_t seed, const Workplace& workplace)
      : cell_(cell), judge_(cell), place_(workplace)
  {
    result_.seed = seed;
    result_.filled = static_cast<int>(cell.bodies().size());
  }

  Emptying run()
  {
    int fruitless = 0;
    while (!cell_.bodies().empty() && fruitless < place_.settings.max_fruitless &&
           failures_ < place_.settings.max_failures && !isAtLimit())
      fruitless = oneCloud() ? 0 : fruitless + 1;
    if (cell_.bodies().empty())
      result_.left.clear();
    return std::move(result_);
  }

private:
  bool isAtLimit() const
  {
    const int limit = place_.settings.max_picks;
    return limit > 0 && static_cast<int>(result_.attempts.size()) >= limit;
  }

  DetectionResult detect(const CellScan& scan)
  {
    Detector::Request request;
    request.bin = cell_.bin();
    const Clock clock;
    DetectionResult result = place_.detector.detect(scan.scan.grid, request);
    result_.detection_seconds.push_back(clock.seconds());
    if (place_.settings.truth)
      result.detections = trueDetections(scan, cell_, place_.detector);
    return result;
  }

  GraspPlan plan(const DetectionResult& found)
  {
    const auto avoid = [&](std::size_t detection) {
      return std::string(avoided_.contains(middleInBin(found.detections[detection])) ? "an attempt there failed" : "");
    };
    const Clock clock;
    GraspPlan plan = planGrasps(place_.planner, place_.detector, found, cell_.bin(), place_.T_base_camera, avoid);
    result_.planning_seconds.push_back(clock.seconds());
    return plan;
  }

  Eigen::Vector3d middleInBin(const Detection& detection) const
  {
    return cell_.bin().T_camera_bin.inverse() * detection.T_camera_object *
           place_.detector.models()[detection.model_index]->center;
  }

  /// \return whether there was an allowed grasp
  bool oneCloud()
  {
    ++clouds_;
    const CellScan scan = cell_.scan(result_.seed * 1000 + static_cast<std::uint32_t>(clouds_));
    const DetectionResult found = detect(scan);
    const GraspPlan planned = plan(found);
    now_ += planned.grasps.empty() ? WAIT : CYCLE;
    avoided_.tick(now_);
    const bool is_allowed = !planned.grasps.empty();
    if (is_allowed)
      attempt(planned.grasps.front(), found.detections[planned.grasps.front().detection], scan);
    // After the attempt, for what it took is not left; before the shake, which gives all parts other ids.
    result_.left = leftovers(scan, cell_, place_.detector, found, planned);
    if (!is_allowed && place_.settings.shake)
      shake();
    return is_allowed;
  }

  void shake()
  {
    ++result_.shakes;
    cell_.shake(result_.seed * 1000 + 500 + static_cast<std::uint32_t>(result_.shakes));
    avoided_.clear();
  }

  void attempt(const PlannedGrasp& grasp, const Detection& detection, const CellScan& scan)
  {
    const auto meant = trueInstance(detection, scan, cell_, place_.detector);
    Attempt attempt = describe(grasp, detection);
    if (meant)
      measureError(attempt, detection, scan.instances[*meant].T_camera_object);
    const Pose T_bin_camera = cell_.bin().T_camera_bin.inverse();
    const simulation::GripPath path{T_bin_camera * grasp.T_camera_tool0_pre_grasp,
                                    T_bin_camera * grasp.T_camera_tool0_grasp,
                                    T_bin_camera * grasp.T_camera_tool0_retreat, grasp.opening, grasp.width};
    const Clock clock;
    attempt.verdict = judge_.tryGrip(cell_.bodies(), place_.planner.setup().gripper, path,
                                     meant ? scan.instances[*meant].id : -1, place_.settings.grip);
    result_.judging_seconds.push_back(clock.seconds());
    attempt.called_free = grasp.vouched_for && attempt.verdict.outcome == GripVerdict::Outcome::Collision;
    const bool is_taken = attempt.verdict.outcome == GripVerdict::Outcome::Taken;
    attempt.another_part = is_taken && !meant;
    if (attempt.another_part)
      attempt.verdict.what = "No " + detection.part + " lies where it was detected. " + attempt.verdict.what;
    failures_ = attempt.succeeded() ? 0 : failures_ + 1;
    avoided_.report(outcomeOf(attempt), middleInBin(detection), now_, detection.part);
    if (is_taken)
      cell_.remove(attempt.verdict.id);
    result_.attempts.push_back(std::move(attempt));
  }

  Attempt describe(const PlannedGrasp& grasp, const Detection& detection) const
  {
    Attempt attempt;
    attempt.seed = result_.seed;
    attempt.cloud = clouds_;
    attempt.part = detection.part;
    attempt.grasp = grasp.id;
    attempt.tilt = grasp.tilt;
    attempt.clearance = grasp.clearance;
    attempt.matching_rate = detection.matching_rate;
    attempt.score = detection.score;
    attempt.center_error = attempt.rotation_error = std::numeric_limits<double>::quiet_NaN();
    return attempt;
  }

  void measureError(Attempt& attempt, const Detection& detection, const Pose& T_camera_truth) const
  {
    const TrainedModel& model = *place_.detector.models()[detection.model_index];
    const Pose T = nearestEquivalent(T_camera_truth, detection.T_camera_object, model.symmetry);
    attempt.center_error = (T * model.center - detection.T_camera_object * model.center).norm();
    attempt.rotation_error = Eigen::AngleAxisd(T.linear().transpose() * detection.T_camera_object.linear()).angle();
  }

  VirtualCell& cell_;
  simulation::GripJudge judge_;
  Workplace place_;
  AvoidList avoided_{AvoidParameters()};
  double now_ = 0;  ///< seconds since the bin was filled, as a cell would count them
  Emptying result_;
  int clouds_ = 0;
  int failures_ = 0;  ///< in a row
};
}  // namespace

Emptying emptyBin(VirtualCell& cell, const std::vector<int>& counts, std::uint32_t seed, const Workplace& workplace)
{
  cell.clear();
  cell.fill(counts, seed);
  return Session(cell, seed, workplace).run();
}
}  // namespace bin_picking::picking
