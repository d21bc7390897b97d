// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/rivals.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "bin_picking_perception/model/slight_turn.hpp"
#include "contradiction.hpp"

namespace bin_picking
{
namespace
{
constexpr double OTHER_POSE = 0.1;  // of the diameter: nearer rivals are the same for a gripper
constexpr std::size_t REFINED_RIVALS = 3;
constexpr int MOST_RESTARTS = 2;
constexpr int FINE_STEPS = 4;         // to either side
constexpr double FINE_ANGLE = 0.044;  // rad: together half a step of the near symmetries

/// The best turn about the axis next to one of the steps. \param least contradiction of the step itself
Pose betweenSteps(const Pose& step, const Symmetry::Axis& axis, const Contradiction& contradiction, double least)
{
  Pose best = step;
  for (int k = -FINE_STEPS; k <= FINE_STEPS; ++k)
  {
    const Pose turn = step * rotationAbout(axis, k * FINE_ANGLE);
    const double against = contradiction(turn);
    if (against < least)
    {
      least = against;
      best = turn;
    }
  }
  return best;
}

/// Turns from a pose to its rivals; the first is none.
struct Turns
{
  std::vector<Pose> steps;      ///< the near symmetries
  std::vector<Pose> refined;    ///< where they led to
  std::vector<double> against;  ///< what contradicts these
};

Turns turnsOf(const TrainedModel& model)
{
  Turns turns;
  turns.steps = {Pose::Identity()};
  for (const NearSymmetry& near : model.near_symmetries)
    turns.steps.push_back(near.T_object_object);
  turns.refined = turns.steps;
  return turns;
}

/// Turns of what is nearly a body of revolution take it to no other place, however far it was off.
bool leadsBeside(const NearSymmetry& near) { return !near.slight_all_around; }

/// The few that the scene contradicts least.
void refineNearest(const TrainedModel& model, const Pose& T_camera_object, const Contradiction& contradiction,
                   const std::function<Pose(const Pose&)>& refine, Turns& turns)
{
  std::vector<std::size_t> order;
  for (std::size_t k = 1; k < turns.steps.size(); ++k)
    if (leadsBeside(model.near_symmetries[k - 1]))
      order.push_back(k);
  const std::size_t few = std::min(REFINED_RIVALS, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(few), order.end(),
                    [&](std::size_t a, std::size_t b) { return turns.against[a] < turns.against[b]; });
  const double hopeless = *std::min_element(turns.against.begin(), turns.against.end()) + MOST_MARGIN;
  for (std::size_t k = 0; k < few && turns.against[order[k]] < hopeless; ++k)
  {
    const std::size_t rival = order[k];
    const Pose turn = T_camera_object.inverse() * refine(T_camera_object * turns.steps[rival]);
    const double against = contradiction(turn);
    if (against >= turns.against[rival])
      continue;
    turns.against[rival] = against;
    turns.refined[rival] = turn;
  }
}

/// Another pose than the chosen one.
struct Rival
{
  Pose turn;                             ///< from the chosen pose to it, part frame
  double margin = 0;                     ///< by which it is contradicted more
  const NearSymmetry* slight = nullptr;  ///< what that turn is, if it is slight
};

/// Turns about one axis that lead from the chosen pose to others, modulo the part's symmetry.
class TurnsAbout
{
public:
  TurnsAbout(const TrainedModel& model, const NearSymmetry& one)
      : model_(model), axis_(one.axis), any_(one.slight_all_around)
  {
    int largest = 0;
    axis_.direction.cwiseAbs().maxCoeff(&largest);
    if (axis_.direction[largest] < 0)
      axis_.direction = -axis_.direction;  // as a person would write it
  }

  bool leadTo(const Rival& rival) const
  {
    constexpr double SAME = 0.02;  // of the diameter
    if (rival.slight == nullptr)
      return false;
    const Pose& turn = rival.slight->T_object_object;
    return isSameLine(rival.slight->axis, axis_, SAME * model_.diameter) ||
           farthestMotion(model_, turn, rotationAbout(axis_, angleAbout(axis_, turn))) < SAME * model_.diameter;
  }

  /// What those of the rivals leave open that cannot be told from the chosen pose.
  UndeterminedTurn undetermined(const std::vector<Rival>& rivals, double min_margin) const
  {
    UndeterminedTurn open{axis_, {}, 0};
    for (const Rival& rival : rivals)
      if (rival.margin < min_margin && leadTo(rival))
      {
        open.deviation = std::max(open.deviation, rival.slight->deviation);
        if (!any_)
          open.angles.push_back(angleAbout(axis_, rival.slight->T_object_object));
      }
    std::sort(open.angles.begin(), open.angles.end());
    open.angles.erase(std::unique(open.angles.begin(), open.angles.end(),
                                  [](double a, double b) { return b - a < M_PI / NEAR_SYMMETRY_STEPS; }),
                      open.angles.end());
    return open;
  }

  /// Smallest margin of the rivals that the open turns do not lead to.
  double marginBeyond(const std::vector<Rival>& rivals, double min_margin) const
  {
    double margin = std::numeric_limits<double>::infinity();
    for (const Rival& rival : rivals)
      if (!leadTo(rival) || (!any_ && rival.margin >= min_margin))
        margin = std::min(margin, rival.margin);
    return margin;
  }

private:
  const TrainedModel& model_;
  Symmetry::Axis axis_;
  bool any_;
};

/// Where the slight rivals alone cannot be told apart, that is a turn left open.
void leaveTurnOpen(const TrainedModel& model, std::vector<Rival>& rivals, double min_margin, RivalChoice& choice)
{
  const Rival* nearest = nullptr;
  for (Rival& rival : rivals)
  {
    rival.slight = slightTurn(model, rival.turn);
    if (rival.slight != nullptr && rival.margin < min_margin && (nearest == nullptr || rival.margin < nearest->margin))
      nearest = &rival;
  }
  if (nearest == nullptr)
    return;
  const TurnsAbout turns(model, *nearest->slight);
  choice.undetermined_turn = turns.undetermined(rivals, min_margin);
  choice.margin_beyond_turn = turns.marginBeyond(rivals, min_margin);
}

/// The pose and its rivals as far as the nearest of them were refined.
struct Judgement
{
  RivalChoice choice;
  bool is_elsewhere = false;  ///< the choice may lie beside where a turn led to
};

Judgement judgeRivals(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                      const DepthGrid& surroundings, double tolerance, double min_margin,
                      const std::function<Pose(const Pose&)>& refine)
{
  Judgement judgement;
  RivalChoice& choice = judgement.choice;
  choice.T_camera_object = T_camera_object;
  Turns turns = turnsOf(model);
  Contradiction contradiction(model, T_camera_object, grid, surroundings, tolerance);
  turns.against = contradiction.ofAll(turns.steps);
  refineNearest(model, T_camera_object, contradiction, refine, turns);
  const std::vector<double>& against = turns.against;
  const auto best = static_cast<std::size_t>(std::min_element(against.begin(), against.end()) - against.begin());
  if (best > 0)
  {
    judgement.is_elsewhere = leadsBeside(model.near_symmetries[best - 1]);
    choice.turned = true;
    choice.T_camera_object = T_camera_object * betweenSteps(turns.refined[best], model.near_symmetries[best - 1].axis,
                                                            contradiction, against[best]);
    choice.T_camera_object.linear() =
        Eigen::Quaterniond(choice.T_camera_object.linear()).normalized().toRotationMatrix();
  }
  // Steps against steps: a turn between them would seem surer than it is, for the others were not turned further.
  std::vector<Rival> rivals;
  for (std::size_t k = 0; k < against.size(); ++k)
    if (k != best &&
        farthestMotion(model, T_camera_object * turns.refined[k], choice.T_camera_object) > OTHER_POSE * model.diameter)
    {
      rivals.push_back({turns.steps[best].inverse() * turns.steps[k], against[k] - against[best]});
      choice.margin = std::min(choice.margin, rivals.back().margin);
    }
  choice.margin_beyond_turn = choice.margin;
  if (choice.margin < min_margin)
    leaveTurnOpen(model, rivals, min_margin, choice);
  return judgement;
}
}  // namespace

RivalChoice chooseAmongRivals(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                              const DepthGrid& surroundings, double tolerance, double min_margin,
                              const std::function<Pose(const Pose&)>& refine)
{
  if (model.near_symmetries.empty())
  {
    RivalChoice alone;
    alone.T_camera_object = T_camera_object;
    return alone;
  }
  const auto judge = [&](const Pose& pose) {
    return judgeRivals(model, pose, grid, surroundings, tolerance, min_margin, refine);
  };
  Judgement judgement = judge(T_camera_object);
  // A rival that was refined to its place comes off better than those that were not: they are judged again from there,
  // and what came near in any judgement counts.
  for (int again = 0; judgement.is_elsewhere && again < MOST_RESTARTS; ++again)
  {
    Judgement next = judge(refine(judgement.choice.T_camera_object));
    next.choice.turned = true;
    next.choice.margin = std::min(next.choice.margin, judgement.choice.margin);
    next.choice.margin_beyond_turn = std::min(next.choice.margin_beyond_turn, judgement.choice.margin_beyond_turn);
    judgement = next;
  }
  return judgement.choice;
}
}  // namespace bin_picking
