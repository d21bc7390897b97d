// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "pick_memory.hpp"

#include <utility>

#include "return_code.hpp"

namespace bin_picking_ros
{
namespace
{
using bin_picking::PickOutcome;
using bin_picking_perception::ReportPick;

PickOutcome toOutcome(std::uint8_t value)
{
  switch (value)
  {
    case ReportPick::Request::PICKED:
      return PickOutcome::Picked;
    case ReportPick::Request::MISSED:
      return PickOutcome::Missed;
    case ReportPick::Request::DROPPED:
      return PickOutcome::Dropped;
    case ReportPick::Request::COLLISION:
      return PickOutcome::Collision;
    case ReportPick::Request::NOT_ATTEMPTED:
      return PickOutcome::NotAttempted;
    default:
      throw RequestError(ReturnCode::INVALID_ARGUMENT,
                         "The outcome is " + std::to_string(value) +
                             "; it must be PICKED (0), MISSED (1), DROPPED (2), COLLISION (3) or NOT_ATTEMPTED (4).");
  }
}
}  // namespace

PickMemory::PickMemory(const bin_picking::AvoidParameters& parameters, std::size_t max_answers, std::string run)
    : list_(parameters), max_answers_(max_answers), run_(std::move(run))
{}

std::string PickMemory::nextAnswer()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return run_ + "-" + std::to_string(++num_answers_);
}

void PickMemory::remember(std::vector<GivenGrasp> grasps, Channel channel)
{
  if (grasps.empty())
    return;  // an answer without grasps must not push out one that is being worked on
  const std::lock_guard<std::mutex> lock(mutex_);
  std::deque<Answer>& answers = answers_[channel == Channel::Service ? 0 : 1];
  answers.push_back({std::move(grasps), {}});
  while (answers.size() > max_answers_)
    answers.pop_front();
}

std::vector<std::optional<bin_picking::AvoidedPlace>> PickMemory::avoided(const std::vector<Eigen::Vector3d>& centers,
                                                                          double now)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  list_.tick(now);
  std::vector<std::optional<bin_picking::AvoidedPlace>> found(centers.size());
  for (std::size_t i = 0; i < centers.size(); ++i)
    if (const bin_picking::AvoidedPlace* place = list_.find(centers[i]))
      found[i] = *place;
  return found;
}

std::vector<bin_picking::AvoidedPlace> PickMemory::places(double now)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  list_.tick(now);
  return list_.places();
}

PickMemory::Found PickMemory::find(const std::string& uid)
{
  for (std::deque<Answer>& answers : answers_)
    for (auto answer = answers.rbegin(); answer != answers.rend(); ++answer)
      for (GivenGrasp& grasp : answer->grasps)
        if (grasp.uid == uid)
          return {*answer, grasp};
  const bool of_this_run = uid.compare(0, run_.size() + 1, run_ + "-") == 0;
  throw RequestError(ReturnCode::GRASP_UNKNOWN,
                     "The grasp \"" + uid + "\" is not among those of the last " + std::to_string(answers_[0].size()) +
                         " answers with grasps" +
                         (of_this_run ? "." : ", and its name is not one that was given out since the node started."));
}

PickMemory::GivenGrasp PickMemory::report(const ReportPick::Request& request, double now)
{
  const PickOutcome outcome = toOutcome(request.outcome);
  const std::lock_guard<std::mutex> lock(mutex_);
  const Found found = find(request.grasp_uid);
  // A grasp can be tried once. A second report is a loop that lost its count: it must not clear or add places.
  const auto [before, is_first] = found.answer.reported.insert({found.grasp.uid, bin_picking::toString(outcome)});
  if (!is_first)
    throw RequestError(ReturnCode::GRASP_UNKNOWN, "The grasp \"" + found.grasp.uid + "\" was reported before, as " +
                                                      before->second + "; a grasp is reported once.");
  list_.report(outcome, found.grasp.center, now, found.grasp.part);
  return found.grasp;
}

std::size_t PickMemory::clear(double now)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  list_.tick(now);
  const std::size_t num_places = list_.places().size();
  list_.clear();
  return num_places;
}
}  // namespace bin_picking_ros
