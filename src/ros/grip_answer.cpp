// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "grip_answer.hpp"

#include "take_part_answer.hpp"

namespace bin_picking_ros
{
namespace
{
using bin_picking::simulation::GripVerdict;

std::int8_t toCode(const GripOutcome& outcome)
{
  if (outcome.verdict.outcome == GripVerdict::Outcome::Collision)
    return GripResponse::COLLISION;
  if (outcome.verdict.outcome == GripVerdict::Outcome::Missed)
    return GripResponse::MISSED;
  switch (outcome.kind)
  {
    case PickOutcome::Kind::Taken:
      return GripResponse::TAKEN;
    case PickOutcome::Kind::DroppedBack:
      return GripResponse::DROPPED_BACK;
    default:
      return GripResponse::MISSED;
  }
}

/// A grip that is good by its geometry and failed by chance.
std::string badLuck(std::int8_t code, const std::string& part)
{
  return code == GripResponse::MISSED ? "The grip was good but missed " + part + " by chance (failure_probability)."
                                      : "Lost " + part + ", which fell back into the bin (drop_probability).";
}
}  // namespace

GripResponse toAnswer(const GripOutcome& outcome, const std::optional<int>& meant)
{
  GripResponse answer;
  answer.outcome = toCode(outcome);
  answer.id = outcome.verdict.id;
  answer.part = outcome.part;
  answer.final_opening = outcome.verdict.final_opening;
  answer.offset = outcome.verdict.offset;
  answer.num_left = static_cast<std::uint32_t>(outcome.num_left);
  answer.what = outcome.verdict.what;
  const bool is_good = outcome.verdict.outcome == GripVerdict::Outcome::Taken;
  if (is_good && outcome.kind != PickOutcome::Kind::Taken)
    answer.what = badLuck(answer.outcome, "part " + std::to_string(answer.id) + " (" + answer.part + ")");
  if (meant && answer.id >= 0 && *meant != answer.id)
    answer.what += " Meant was part " + std::to_string(*meant) + ".";
  answer.what += " " + partsText(outcome.num_left) + " left.";
  return answer;
}

GripResponse failedGrip(const ReturnCode& code)
{
  GripResponse answer;
  answer.outcome = outcomeOfFailure<GripResponse>(code);
  answer.id = -1;
  answer.what = code.message;
  return answer;
}
}  // namespace bin_picking_ros
