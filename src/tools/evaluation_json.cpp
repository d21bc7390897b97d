// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>

#include "evaluation_report.hpp"
#include "report.hpp"

namespace bin_picking::tools
{
namespace
{
using Json = nlohmann::json;

constexpr double DEGREES = 180 / M_PI;

Json ratioJson(const Ratio& ratio)
{
  const Interval interval = ratio.interval();
  return {{"hits", ratio.hits},
          {"total", ratio.total},
          {"value", ratio.value()},
          {"interval_95", {interval.low, interval.high}}};
}

Json spreadJson(const Spread& spread, double scale)
{
  return {{"median", spread.median * scale}, {"p95", spread.p95 * scale}, {"count", spread.count}};
}

Json calibrationJson(const Calibration& calibration)
{
  Json json = {{"count", calibration.count},
               {"brier_score", calibration.brier_score},
               {"expected_error", calibration.expected_error},
               {"tenths", Json::array()}};
  for (const CalibrationBin& tenth : calibration.tenths)
    json["tenths"].push_back({{"mean_score", tenth.mean_score}, {"right", ratioJson(tenth.right)}});
  return json;
}

Json figuresJson(const EvaluationFigures& f)
{
  Json json = {{"scenes", f.scenes},
               {"instances", f.instances},
               {"pickable", f.pickable},
               {"right", f.right},
               {"hidden", f.hidden},
               {"duplicates", f.duplicates},
               {"wrong", f.wrong},
               {"precision", ratioJson(f.precision)},
               {"undetermined_turns", ratioJson(f.undetermined)},
               {"recall", Json::array()},
               {"precision_of_first", Json::array()},
               {"average_precision", nullptr}};
  for (const RecallAtLevel& recall : f.recall)
  {
    json["recall"].push_back(ratioJson(recall.ratio));
    json["recall"].back()["visible_fraction"] = recall.level;
    json["recall"].back()["turn_known"] = ratioJson(recall.turn_known);
  }
  for (const FirstPrecision& first : f.first)
  {
    json["precision_of_first"].push_back(ratioJson(first.ratio));
    json["precision_of_first"].back()["first"] = first.first;
  }
  if (f.average_precision)
    json["average_precision"] = *f.average_precision;
  json["false_in_empty"] = f.false_in_empty;
  json["empty_scenes_with_false"] = ratioJson(f.empty_scenes);
  json["translation_mm"] = spreadJson(f.translation, 1000);
  json["rotation_deg"] = spreadJson(f.rotation, DEGREES);
  json["add_s_mm"] = spreadJson(f.mean_distance, 1000);
  json["add_s_recall"] = ratioJson(f.mean_distance_recall);
  if (f.tested.count > 0)
    json["calibration"] = {{"tested", calibrationJson(f.tested)}, {"returned", calibrationJson(f.returned)}};
  return json;
}

Json estimateJson(const JudgedScene& scene, std::size_t index)
{
  const JudgedEstimate& judged = scene.estimates[index];
  Json json = {{"part", judged.estimate.part},
               {"score", judged.estimate.score},
               {"T_camera_object", toJson(judged.estimate.T_camera_object)},
               {"verdict", toString(judged.verdict)},
               {"text", verdictText(scene, index)},
               {"instance", nullptr}};
  if (judged.estimate.undetermined_turn)
    json["undetermined_turn"] = toJson(*judged.estimate.undetermined_turn);
  if (!judged.instance)
    return json;
  json["instance"] = *judged.instance;
  json["translation_mm"] = judged.error.translation * 1000;
  json["rotation_deg"] = judged.error.rotation * DEGREES;
  json["mssd_mm"] = judged.max_distance * 1000;
  json["add_s_mm"] = judged.mean_distance * 1000;
  return json;
}

Json testedJson(const TestedPose& pose)
{
  const PoseQuality& q = pose.quality;
  Json json = {{"part", pose.part}, {"score", pose.score}, {"accepted", pose.accepted}, {"right", pose.right}};
  json["quality"] = {{"visible_fraction", q.visible_fraction}, {"inlier_share", q.inlier_share},
                     {"violation_share", q.violation_share},   {"surface_share", q.surface_share},
                     {"outline_share", q.outline_share},       {"turn_margin", q.turn_margin},  // infinity is null
                     {"bin_penetration", q.bin_penetration}};
  for (const ConfidenceTerm& term : confidenceTerms(q))
    json["terms"][term.name] = term.value;
  return json;
}

Json instanceJson(const JudgedScene& scene, std::size_t index)
{
  const TrueInstance& instance = scene.scene.instances[index];
  Json json = {{"part", instance.part},
               {"T_camera_object", toJson(instance.T_camera_object)},
               {"visible_fraction", instance.visible_fraction},
               {"found_by", nullptr}};
  if (scene.found_by[index])
    json["found_by"] = *scene.found_by[index];
  if (instance.visible_pixels > 0)
    json["visible_pixels"] = instance.visible_pixels;
  if (instance.valid_pixels > 0)
    json["valid_pixels"] = instance.valid_pixels;
  return json;
}

/// In the order of the pipeline, each with its times of all runs.
Json stagesJson(const std::vector<RunTime>& runs)
{
  Json stages = Json::array();
  for (const RunTime& run : runs)
    for (const StageTime& time : run.stages)
    {
      const auto known = std::find_if(stages.begin(), stages.end(),
                                      [&](const Json& stage) { return stage.at("stage") == time.stage; });
      Json& stage = known == stages.end() ? stages.emplace_back(Json::object({{"stage", time.stage}})) : *known;
      stage["ms"].push_back(time.seconds * 1000);
    }
  return stages;
}
}  // namespace

nlohmann::json toJson(const EvaluationSummary& summary)
{
  Json json = {{"all", figuresJson(summary.all)}, {"parts", Json::object()}, {"timing_ms", Json::object()}};
  for (const EvaluationFigures& part : summary.parts)
    json["parts"][part.part] = figuresJson(part);
  json["timing_ms"]["total"] = spreadJson(summary.total, 1000);
  for (const StageSpread& stage : summary.stages)
    json["timing_ms"][stage.stage] = spreadJson(stage.seconds, 1000);
  return json;
}

nlohmann::json toJson(const JudgedScene& scene)
{
  Json json = {{"name", scene.scene.name},   {"scene_id", scene.scene.scene_id}, {"image_id", scene.scene.image_id},
               {"parts", scene.scene.parts}, {"instances", Json::array()},       {"estimates", Json::array()},
               {"total_ms", Json::array()},  {"counts", Json::object()}};
  for (std::size_t i = 0; i < scene.scene.instances.size(); ++i)
    json["instances"].push_back(instanceJson(scene, i));
  for (std::size_t e = 0; e < scene.estimates.size(); ++e)
    json["estimates"].push_back(estimateJson(scene, e));
  json["tested"] = Json::array();
  for (const TestedPose& pose : scene.tested)
    json["tested"].push_back(testedJson(pose));
  for (const RunTime& run : scene.runs)
    json["total_ms"].push_back(run.total * 1000);
  json["stages"] = stagesJson(scene.runs);
  if (!scene.runs.empty())
    for (const StageCount& count : scene.runs.front().counts)  // the same in every run
      json["counts"][count.stage] = count.count;
  return json;
}
}  // namespace bin_picking::tools
