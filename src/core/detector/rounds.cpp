// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "rounds.hpp"

#include <algorithm>
#include <cstddef>

namespace bin_picking
{
namespace
{
constexpr std::size_t ROUND = 8;
}

Rounds::Rounds(const std::vector<Ranked>& ranked, const TrainedModel& model)
    : same_place_(model, Turns::Slight), rivals_(model, Turns::All)
{
  for (const Ranked& pose : ranked)
    waiting_.push_back({&pose, same_place_.of(pose.pose.T_camera_object)});
}

std::vector<const Ranked*> Rounds::next()
{
  const std::size_t size = std::min(ROUND, waiting_.size());
  std::vector<const Ranked*> round;
  for (std::size_t i = 0; i < size; ++i)
    round.push_back(waiting_[i].pose);
  waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(size));
  return round;
}

std::vector<const Ranked*> Rounds::next(const std::vector<int>& explained, const std::vector<Assessed>& assessed)
{
  constexpr double EXPLAINED = 0.6;
  const std::vector<Place> ends = endsOf(assessed);
  std::vector<const Ranked*> round;
  std::vector<Place> places;
  std::vector<Waiting> left;
  for (const Waiting& one : waiting_)
  {
    if (round.size() == ROUND || rivals_.isAmong(places, one.place))
      left.push_back(one);
    else if (sharedPart(one.pose->cells, explained) < EXPLAINED && !same_place_.isAmong(ends, one.place))
    {
      round.push_back(one.pose);
      places.push_back(one.place);
    }
  }
  waiting_ = std::move(left);
  return round;
}

/// Where refinement has led already, wherever it started: it would lead there again.
std::vector<Place> Rounds::endsOf(const std::vector<Assessed>& assessed) const
{
  std::vector<Place> ends(assessed.size());
  std::transform(assessed.begin(), assessed.end(), ends.begin(),
                 [this](const Assessed& one) { return same_place_.of(one.detection.T_camera_object); });
  return ends;
}
}  // namespace bin_picking
