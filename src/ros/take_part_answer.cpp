// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "take_part_answer.hpp"

#include <sstream>

namespace bin_picking_ros
{
namespace
{
std::int8_t toCode(PickOutcome::Kind kind)
{
  switch (kind)
  {
    case PickOutcome::Kind::Taken:
      return TakePartResponse::TAKEN;
    case PickOutcome::Kind::Missed:
      return TakePartResponse::MISSED;
    case PickOutcome::Kind::DroppedBack:
      return TakePartResponse::DROPPED_BACK;
    case PickOutcome::Kind::NoSuchPart:
      break;
  }
  return TakePartResponse::NO_SUCH_PART;
}

std::string describe(PickOutcome::Kind kind, const std::string& part)
{
  switch (kind)
  {
    case PickOutcome::Kind::Taken:
      return "Took " + part + "; ";
    case PickOutcome::Kind::Missed:
      return "The grip missed " + part + "; ";
    case PickOutcome::Kind::DroppedBack:
      return "Lost " + part + ", which fell back into the bin; ";
    case PickOutcome::Kind::NoSuchPart:
      break;
  }
  return "There is no " + part + "; look at the newest ~truth; ";
}
}  // namespace

std::string partsText(std::size_t count) { return std::to_string(count) + (count == 1 ? " part" : " parts"); }

TakePartResponse toAnswer(const PickOutcome& outcome, int id)
{
  TakePartResponse answer;
  answer.outcome = toCode(outcome.kind);
  answer.id = outcome.id;
  answer.part = outcome.part;
  answer.num_left = static_cast<std::uint32_t>(outcome.num_left);
  const std::string part = "part " + std::to_string(id) + (outcome.part.empty() ? "" : " (" + outcome.part + ")");
  answer.message = describe(outcome.kind, part) + partsText(outcome.num_left) + " left.";
  return answer;
}

TakePartResponse nothingThere(const bin_picking_perception::TakePart::Request& request, std::size_t num_left)
{
  TakePartResponse answer;
  answer.outcome = TakePartResponse::NO_SUCH_PART;
  answer.id = -1;
  answer.num_left = static_cast<std::uint32_t>(num_left);
  const auto& p = request.pose.pose.position;
  std::ostringstream text;
  text.precision(4);
  text << "No " << (request.part.empty() ? "part" : request.part) << " lies at [" << p.x << ", " << p.y << ", " << p.z
       << "] m in " << request.pose.header.frame_id << "; ";
  answer.message = text.str() + partsText(num_left) + " left.";
  return answer;
}

TakePartResponse failedAnswer(const ReturnCode& code)
{
  TakePartResponse answer;
  answer.outcome = outcomeOfFailure<TakePartResponse>(code);
  answer.id = -1;
  answer.num_left = 0;
  answer.message = code.message;
  return answer;
}
}  // namespace bin_picking_ros
