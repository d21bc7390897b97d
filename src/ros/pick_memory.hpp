// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <bin_picking_perception/ReportPick.h>

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bin_picking_perception/grasping/avoid_list.hpp"

namespace bin_picking_ros
{
/// The grasps that were given out lately, and the places where attempts failed. Positions are in one fixed frame (see
/// AvoidList), times in seconds. Thread-safe; memory is bounded by the number of remembered answers.
class PickMemory
{
public:
  /// A grasp as it was given out.
  struct GivenGrasp
  {
    std::string uid;
    std::string part;
    std::string grasp_id;
    Eigen::Vector3d center;  ///< middle of the part
  };

  /// \param run a short word that differs from run to run of the node, so that no grasp of an earlier run is mistaken
  /// for one of this
  PickMemory(const bin_picking::AvoidParameters& parameters, std::size_t max_answers, std::string run);

  /// The beginning of the names of the next answer's grasps; grasp k is <this>-<k>.
  std::string nextAnswer();

  /// How grasps were given out. Of either kind as many answers are remembered: continuous processing must not push out
  /// the answer that a robot is working on.
  enum class Channel
  {
    Service,
    Topic
  };

  /// Remembers an answer and forgets the oldest one of its kind.
  void remember(std::vector<GivenGrasp> grasps, Channel channel);

  /// For each of these middles of parts, the place that it is avoided for.
  std::vector<std::optional<bin_picking::AvoidedPlace>> avoided(const std::vector<Eigen::Vector3d>& centers,
                                                                double now);
  /// All places that are avoided now.
  std::vector<bin_picking::AvoidedPlace> places(double now);

  /// Notes what became of a grasp. \return what was meant by it
  /// \throws RequestError GRASP_UNKNOWN never given out, forgotten or reported before; INVALID_ARGUMENT outcome
  GivenGrasp report(const bin_picking_perception::ReportPick::Request& request, double now);

  /// Forgets all places. \return how many there were
  std::size_t clear(double now);

private:
  struct Answer
  {
    std::vector<GivenGrasp> grasps;
    std::map<std::string, std::string> reported;  ///< uid -> outcome
  };
  struct Found
  {
    Answer& answer;
    GivenGrasp& grasp;
  };
  Found find(const std::string& uid);

  std::mutex mutex_;
  bin_picking::AvoidList list_;
  const std::size_t max_answers_;
  const std::string run_;
  std::uint64_t num_answers_ = 0;
  std::array<std::deque<Answer>, 2> answers_;  ///< per channel, newest last
};
}  // namespace bin_picking_ros
