// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <nlohmann/json.hpp>

#include "report.hpp"

namespace bin_picking::picking
{
namespace
{
using nlohmann::json;

const char* outcomeText(const Attempt& attempt)
{
  return attempt.another_part ? "another_part" : toString(attempt.verdict.outcome);
}

json toJson(const Attempt& attempt)
{
  const simulation::GripVerdict& verdict = attempt.verdict;
  return {{"cloud", attempt.cloud},
          {"part", attempt.part},
          {"grasp", attempt.grasp},
          {"tilt", attempt.tilt},
          {"clearance", attempt.clearance},
          {"matching_rate", attempt.matching_rate},
          {"score", attempt.score},
          {"center_error", attempt.center_error},
          {"rotation_error", attempt.rotation_error},
          {"outcome", outcomeText(attempt)},
          {"cause", causeOf(attempt)},
          {"id", verdict.id},
          {"final_opening", verdict.final_opening},
          {"offset", verdict.offset},
          {"body", verdict.body},
          {"obstacle", verdict.obstacle_name},
          {"depth", verdict.depth},
          {"called_free", attempt.called_free},
          {"what", verdict.what}};
}

json toJson(const Emptying& bin)
{
  json result = {
      {"seed", bin.seed},
      {"filled", bin.filled},
      {"shakes", bin.shakes},
      {"left", bin.left},
      {"attempts", json::array()},
      {"seconds",
       {{"detection", bin.detection_seconds}, {"grasps", bin.planning_seconds}, {"judge", bin.judging_seconds}}}};
  for (const Attempt& attempt : bin.attempts)
    result["attempts"].push_back(toJson(attempt));
  return result;
}
}  // namespace

std::string toJson(const Study& study)
{
  json result = {{"command", study.command}, {"version", study.version}, {"sensor", study.sensor},
                 {"gripper", study.gripper}, {"truth", study.truth},     {"parts", json::array()}};
  for (const PartStudy& part : study.parts)
  {
    json bins = json::array();
    for (const Emptying& bin : part.bins)
      bins.push_back(toJson(bin));
    result["parts"].push_back({{"name", part.name}, {"bins", bins}});
  }
  return result.dump(1) + "\n";
}
}  // namespace bin_picking::picking
