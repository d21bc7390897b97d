// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_emptying.hpp"

#include <algorithm>
#include <chrono>

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

constexpr double AVOID_RADIUS = 0.025;  // metres round the middle of a part that a grip has failed on
constexpr int AVOID_ANSWERS = 3;
constexpr double MIN_VISIBLE = 0.3;  // share of a part that is seen, from which on the truth counts as a detection

class Clock
{
public:
  double seconds() const { return std::chrono::duration<double>(Now::now() - start_).count(); }

private:
  using Now = std::chrono::steady_clock;
  Now::time_point start_ = Now::now();
};

/// Places where grips have failed, for some answers.
class AvoidedPlaces
{
public:
  void add(const Eigen::Vector3d& p) { places_.push_back({p, AVOID_ANSWERS}); }
  bool contains(const Eigen::Vector3d& p) const
  {
    return std::any_of(places_.begin(), places_.end(),
                       [&p](const auto& place) { return (place.first - p).norm() < AVOID_RADIUS; });
  }
  void nextAnswer()
  {
    for (auto& place : places_)
      --place.second;
    places_.erase(std::remove_if(places_.begin(), places_.end(), [](const auto& p) { return p.second < 0; }),
                  places_.end());
  }

private:
  std::vector<std::pair<Eigen::Vector3d, int>> places_;
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

bool vouchedAgainst(const GripVerdict& verdict, const Checked& checked)
{
  if (verdict.outcome != GripVerdict::Outcome::Collision)
    return false;
  if (verdict.body == "held part")
    return checked.held_part;
  if (verdict.stage == GripStage::Closing)
    return checked.closing;
  return verdict.obstacle == GripObstacle::Bin ? checked.bin : checked.parts;
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
    while (!cell_.bodies().empty() && fruitless < place_.settings.max_fruitless && !isAtLimit())
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
    const Clock clock;
    GraspPlan plan = planGrasps(place_.setup, found, cell_.bin());
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
    const auto grasp = std::find_if(planned.grasps.begin(), planned.grasps.end(), [&](const PlannedGrasp& g) {
      return !avoided_.contains(middleInBin(found.detections[g.detection]));
    });
    avoided_.nextAnswer();
    result_.left = leftovers(scan, cell_, place_.detector, found, planned);
    if (grasp == planned.grasps.end())
      return false;
    attempt(*grasp, found.detections[grasp->detection], scan, planned.checked);
    return true;
  }

  void attempt(const PlannedGrasp& grasp, const Detection& detection, const CellScan& scan, const Checked& checked)
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
    attempt.verdict = judge_.tryGrip(cell_.bodies(), place_.setup.gripper, path, meant ? scan.instances[*meant].id : -1,
                                     place_.settings.grip);
    result_.judging_seconds.push_back(clock.seconds());
    attempt.called_free = vouchedAgainst(attempt.verdict, checked);
    if (attempt.verdict.outcome == GripVerdict::Outcome::Taken)
      cell_.remove(attempt.verdict.id);
    else
      avoided_.add(middleInBin(detection));
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
  AvoidedPlaces avoided_;
  Emptying result_;
  int clouds_ = 0;
};
}  // namespace

Emptying emptyBin(VirtualCell& cell, const std::vector<int>& counts, std::uint32_t seed, const Workplace& workplace)
{
  cell.clear();
  cell.fill(counts, seed);
  return Session(cell, seed, workplace).run();
}
}  // namespace bin_picking::picking
