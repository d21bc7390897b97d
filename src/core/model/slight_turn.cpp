// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/slight_turn.hpp"

#include <algorithm>
#include <cmath>

#include "axis_text.hpp"
#include "bin_picking_perception/common/figures.hpp"

namespace bin_picking
{
namespace
{
constexpr double SAME_MOTION = 0.01;  // of the diameter, at the box's corners

bool isSameMotion(const TrainedModel& model, const Pose& a, const Pose& b)
{
  return farthestMotion(model, a, b) < SAME_MOTION * model.diameter;
}

std::vector<const NearSymmetry*> slightTurnsAbout(const TrainedModel& model, const Symmetry::Axis& axis)
{
  std::vector<const NearSymmetry*> turns;
  for (const NearSymmetry& near : model.near_symmetries)
    if (near.slight && near.axis.direction == axis.direction && near.axis.origin == axis.origin)
      turns.push_back(&near);
  return turns;
}

/// "120, 240".
std::string anglesText(const std::vector<const NearSymmetry*>& turns)
{
  std::string text;
  for (const NearSymmetry* turn : turns)
    text += (text.empty() ? "" : ", ") +
            std::to_string(std::lround(angleAbout(turn->axis, turn->T_object_object) * 180 / M_PI));
  return text;
}
}  // namespace

double farthestMotion(const TrainedModel& model, const Pose& a, const Pose& b)
{
  const Pose nearest = nearestEquivalent(a, b, model.symmetry);
  double farthest = 0;
  for (int k = 0; k < 8; ++k)
  {
    const Eigen::Vector3d corner =
        model.center + 0.5 * model.size.cwiseProduct(Eigen::Vector3d(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
    farthest = std::max(farthest, (nearest * corner - b * corner).norm());
  }
  return farthest;
}

double angleAbout(const Symmetry::Axis& axis, const Pose& turn)
{
  const Eigen::AngleAxisd rotation(turn.linear());
  const double angle = rotation.axis().dot(axis.direction) < 0 ? -rotation.angle() : rotation.angle();
  return angle < 0 ? angle + 2 * M_PI : angle;
}

const NearSymmetry* slightTurn(const TrainedModel& model, const Pose& T_object_object)
{
  const auto found =
      std::find_if(model.near_symmetries.begin(), model.near_symmetries.end(), [&](const NearSymmetry& near) {
        return near.slight && isSameMotion(model, T_object_object, near.T_object_object);
      });
  return found == model.near_symmetries.end() ? nullptr : &*found;
}

std::vector<std::string> describeSlightTurns(const TrainedModel& model)
{
  const double slight = model.parameters.slight_deviation * model.diameter;
  const std::string limit = millimetres(slight, 2);
  const std::string small_feature = millimetres(2 * slight, 2) + " where only a small feature tells them";
  std::vector<std::string> sentences;
  for (const NearSymmetry& near : model.near_symmetries)
  {
    const std::vector<const NearSymmetry*> turns = slightTurnsAbout(model, near.axis);
    if (turns.empty() || turns.front() != &near)
      continue;  // the first of an axis speaks for all
    const auto most = std::max_element(turns.begin(), turns.end(), [](const NearSymmetry* a, const NearSymmetry* b) {
      return a->deviation < b->deviation;
    });
    sentences.push_back((near.slight_all_around ? "any turn" : "turns by " + anglesText(turns) + " degrees") +
                        " about " + axisText(near.axis) +
                        " may be left open where a view does not tell: they move the surface by " +
                        millimetres((*most)->deviation, 2) + ", and up to " + limit + " is slight" +
                        ((*most)->deviation > slight ? ", " + small_feature : ""));
  }
  if (sentences.empty() && !model.near_symmetries.empty())
    sentences.push_back("no turn may be left open where a view does not tell: none moves the surface by " + limit +
                        " or less (" + small_feature + "), but small ones");
  return sentences;
}
}  // namespace bin_picking
