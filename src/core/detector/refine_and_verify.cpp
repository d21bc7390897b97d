// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/refinement/icp.hpp"
#include "stages.hpp"

namespace bin_picking
{
namespace
{
/// A pose from votes with what a quick look at the scene says about it.
struct Ranked
{
  Hypothetical pose;
  double score = 0;
  std::vector<int> cells;  ///< that it would explain
};

constexpr double SAME_DISTANCE = 0.07;  // of the diameter

/// A few steps towards the surface: poses from votes are off by so much that right and wrong ones explain about alike.
Pose nudge(const Pose& T_camera_object, const PreparedScene& scene, const TrainedModel& model, IcpParameters icp)
{
  constexpr std::size_t NUDGE_PIXELS = 120;
  constexpr int NUDGE_STEPS = 3;
  if (icp.method != IcpMethod::DistanceField)
    return T_camera_object;
  icp.max_iterations = std::min(icp.max_iterations, NUDGE_STEPS);
  const MeasuredPart measured =
      measuredNear(model, T_camera_object, scene.grid, scene.normals, scene.edges, NUDGE_PIXELS);
  return icpDistanceField(model, measured, T_camera_object, icp).T_camera_object;
}

Ranked lookAt(const Hypothetical& pose, const PreparedScene& scene, const TrainedModel& model,
              const FacingPoints& facing, const DetectorParameters& parameters, int comparison_cell)
{
  const Pose T = nudge(pose.T_camera_object, scene, model, parameters.icp);
  // A leaf is forgiven before the pose is refined.
  const PoseEvidence evidence = gatherEvidence(facing.at(T), T, scene.grid, scene.surroundings, scene.normals,
                                               model.parameters.leaf, parameters.verification);
  return {{T, pose.votes, pose.region},
          promise(evidence, parameters.verification),
          coveredCells(evidence.pixels, scene.grid.width, scene.reduction, comparison_cell)};
}

bool isSmallTurn(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b)
{
  constexpr double COSINE = 0.966;                  // of 15 degrees
  return a.cwiseProduct(b).sum() > 1 + 2 * COSINE;  // the trace of a^T b
}

/// A pose with where it takes the part's middle: most places are told apart by that.
struct Place
{
  Pose T_camera_object;
  Eigen::Vector3d center;
};

/// Near symmetries that two poses may differ by.
enum class Turns
{
  Slight,
  All
};

/// The same place and the same turn, modulo the part's symmetry and some of its near symmetries.
class SamePlace
{
public:
  SamePlace(const TrainedModel& model, Turns turns) : model_(model), near_enough_(SAME_DISTANCE * model.diameter)
  {
    add(Pose::Identity());
    for (const NearSymmetry& near : model.near_symmetries)
      if (near.slight || turns == Turns::All)
        add(near.T_object_object);
  }

  Place of(const Pose& T_camera_object) const { return {T_camera_object, T_camera_object * model_.center}; }

  bool operator()(const Place& a, const Place& b) const
  {
    const double squared = (a.center - b.center).squaredNorm();
    if (squared > reach_ * reach_)
      return false;
    const Pose& T_b = b.T_camera_object;
    const Eigen::Vector3d center = T_b.linear().transpose() * (a.center - T_b.translation());  // of a, as b sees it
    return std::any_of(turns_.begin(), turns_.end(), [&](const Place& turn) {
      return (center - turn.center).squaredNorm() <= near_enough_ * near_enough_ &&
             isSameTurn(a.T_camera_object, T_b * turn.T_camera_object);
    });
  }

private:
  void add(const Pose& turn)
  {
    turns_.push_back(of(turn));
    reach_ = std::max(reach_, near_enough_ + (turns_.back().center - model_.center).norm());
  }

  bool isSameTurn(const Pose& a, const Pose& b) const
  {
    const Pose nearest = model_.symmetry.trivial() ? b : nearestEquivalent(b, a, model_.symmetry);
    return isSmallTurn(a.linear(), nearest.linear());
  }

  const TrainedModel& model_;
  double near_enough_;
  double reach_ = 0;          ///< of the centres of what may be the same place
  std::vector<Place> turns_;  ///< none and others, in the part's frame
};

/// All poses, most promising first, each place once.
std::vector<Ranked> rankPoses(const std::vector<Hypothetical>& poses, const PreparedScene& scene,
                              const TrainedModel& model, const DetectorParameters& parameters, int comparison_cell,
                              const Executor& executor)
{
  std::vector<Ranked> ranked(poses.size());
  if (!parameters.verification.enabled)  // the paper: what the votes put first
  {
    std::transform(poses.begin(), poses.end(), ranked.begin(), [](const Hypothetical& pose) {
      return Ranked{pose, 0, {}};
    });
    return ranked;
  }
  constexpr std::size_t COARSE_POINTS = 64;
  const FacingPoints facing(model, COARSE_POINTS);
  executor.forEach(poses.size(), [&](std::size_t i) {
    ranked[i] = lookAt(poses[i], scene, model, facing, parameters, comparison_cell);
  });
  std::stable_sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) { return a.score > b.score; });
  // Which of slight turns it is, the rivals tell. Of poses that other near symmetries lead to, the one that ranks first
  // need not end at the right turn.
  const SamePlace same_place(model, Turns::Slight);
  std::vector<Place> places;
  std::vector<Ranked> distinct;
  for (Ranked& candidate : ranked)
  {
    const Place place = same_place.of(candidate.pose.T_camera_object);
    if (std::any_of(places.begin(), places.end(), [&](const Place& better) { return same_place(better, place); }))
      continue;
    places.push_back(place);
    distinct.push_back(std::move(candidate));
  }
  return distinct;
}

/// Deals out ranked poses, some at a time. The size of a round does not depend on the number of threads, so neither do
/// the results.
class Rounds
{
public:
  Rounds(const std::vector<Ranked>& ranked, const TrainedModel& model)
      : same_place_(model, Turns::Slight), rivals_(model, Turns::All)
  {
    for (const Ranked& pose : ranked)
      waiting_.push_back({&pose, same_place_.of(pose.pose.T_camera_object)});
  }

  /// The next of all, whatever was found.
  std::vector<const Ranked*> next()
  {
    const std::size_t size = std::min(ROUND, waiting_.size());
    std::vector<const Ranked*> round;
    for (std::size_t i = 0; i < size; ++i)
      round.push_back(waiting_[i].pose);
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(size));
    return round;
  }

  /// The next that lie where nothing was accepted yet and that nobody was led to. Of poses that a near symmetry leads
  /// to from each other, one: settled among its rivals, it would most likely end where the others would, and they wait
  /// until that is known. \param explained ascending
  std::vector<const Ranked*> next(const std::vector<int>& explained, const std::vector<Assessed>& assessed)
  {
    constexpr double EXPLAINED = 0.6;
    const std::vector<Place> ends = endsOf(assessed);
    std::vector<const Ranked*> round;
    std::vector<Place> places;
    std::vector<Waiting> left;
    for (const Waiting& one : waiting_)
    {
      if (round.size() == ROUND || isAt(one.place, places, rivals_))
        left.push_back(one);
      else if (sharedPart(one.pose->cells, explained) < EXPLAINED && !isAt(one.place, ends, same_place_))
      {
        round.push_back(one.pose);
        places.push_back(one.place);
      }
    }
    waiting_ = std::move(left);
    return round;
  }

private:
  static constexpr std::size_t ROUND = 8;

  struct Waiting
  {
    const Ranked* pose;
    Place place;
  };

  /// Where refinement has led already, wherever it started: it would lead there again.
  std::vector<Place> endsOf(const std::vector<Assessed>& assessed) const
  {
    std::vector<Place> ends(assessed.size());
    std::transform(assessed.begin(), assessed.end(), ends.begin(),
                   [this](const Assessed& one) { return same_place_.of(one.detection.T_camera_object); });
    return ends;
  }

  static bool isAt(const Place& place, const std::vector<Place>& others, const SamePlace& same)
  {
    return std::any_of(others.begin(), others.end(), [&](const Place& other) { return same(other, place); });
  }

  SamePlace same_place_;
  SamePlace rivals_;
  std::vector<Waiting> waiting_;  ///< most promising first
};
}  // namespace

int comparisonCell(const PointView& raw, const std::vector<std::shared_ptr<const TrainedModel>>& models)
{
  double leaf = 0;
  for (const auto& model : models)
    leaf = std::max(leaf, model->parameters.leaf);
  const double depth = medianDepth(raw);
  return depth > 0 ? std::max(1, static_cast<int>(std::lround(leaf / raw.pitch(depth)))) : 1;
}

std::vector<Assessed> refineAndVerify(const std::vector<Hypothetical>& poses, const PreparedScene& scene,
                                      const TrainedModel& model, const DetectorParameters& parameters,
                                      int comparison_cell, const Deadline& deadline, const Executor& executor,
                                      StageClock& clock, bool& partial)
{
  const VerificationParameters& verification = parameters.verification;
  const std::vector<Ranked> ranked = rankPoses(poses, scene, model, parameters, comparison_cell, executor);
  clock.lap("ranking");
  Rounds rounds(ranked, model);
  std::vector<Assessed> ready;
  std::vector<int> explained;
  int fruitless = 0;
  const std::size_t limit = verification.enabled ? static_cast<std::size_t>(verification.max_refined) : ranked.size();
  while (ready.size() < limit && fruitless < verification.fruitless_rounds)
  {
    // The paper refines every candidate.
    const std::vector<const Ranked*> round = verification.enabled ? rounds.next(explained, ready) : rounds.next();
    if (round.empty())
      break;
    if (deadline.passed())
    {
      partial = true;
      break;
    }
    std::vector<Assessed> assessed(round.size());
    executor.forEach(round.size(), [&](std::size_t i) {
      assessed[i] = assess(round[i]->pose, scene, model, parameters, comparison_cell);
    });
    ++fruitless;
    for (Assessed& candidate : assessed)
    {
      if (candidate.detection.rejection.empty())
      {
        fruitless = 0;
        explained.insert(explained.end(), candidate.cells.begin(), candidate.cells.end());
      }
      ready.push_back(std::move(candidate));
    }
    std::sort(explained.begin(), explained.end());
  }
  clock.count("refined", static_cast<double>(ready.size()));
  clock.lap("refinement");
  return ready;
}
}  // namespace bin_picking
