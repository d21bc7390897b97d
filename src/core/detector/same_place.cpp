// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "same_place.hpp"

#include <algorithm>

namespace bin_picking
{
namespace
{
constexpr double SAME_DISTANCE = 0.07;  // of the diameter

bool isSmallTurn(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b)
{
  constexpr double COSINE = 0.966;                  // of 15 degrees
  return a.cwiseProduct(b).sum() > 1 + 2 * COSINE;  // the trace of a^T b
}
}  // namespace

SamePlace::SamePlace(const TrainedModel& model, Turns turns)
    : model_(model), near_enough_(SAME_DISTANCE * model.diameter)
{
  add(Pose::Identity());
  for (const NearSymmetry& near : model.near_symmetries)
    if (turns == Turns::All || (turns == Turns::Slight && near.slight))
      add(near.T_object_object);
}

bool SamePlace::operator()(const Place& a, const Place& b) const
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

bool SamePlace::isAmong(const std::vector<Place>& others, const Place& place) const
{
  return std::any_of(others.begin(), others.end(), [&](const Place& other) { return (*this)(other, place); });
}

void SamePlace::add(const Pose& turn)
{
  turns_.push_back(of(turn));
  reach_ = std::max(reach_, near_enough_ + (turns_.back().center - model_.center).norm());
}

bool SamePlace::isSameTurn(const Pose& a, const Pose& b) const
{
  const Pose nearest = model_.symmetry.trivial() ? b : nearestEquivalent(b, a, model_.symmetry);
  return isSmallTurn(a.linear(), nearest.linear());
}
}  // namespace bin_picking
