// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "report.hpp"

#include <algorithm>
#include <iomanip>

#include "bin_picking_perception/common/figures.hpp"
#include "terminal.hpp"

namespace bin_picking::tools
{
namespace
{
using Json = nlohmann::json;

constexpr std::size_t PRINTED_REJECTIONS = 5;

Json detectionJson(const Detection& detection)
{
  Json json;
  json["part"] = detection.part;
  json["T_camera_object"] = toJson(detection.T_camera_object);
  json["score"] = detection.score;
  json["matching_rate"] = detection.matching_rate;
  json["visible_fraction"] = detection.visible_fraction;
  json["rms"] = detection.rms;
  json["votes"] = detection.votes;
  json["criteria"] = Json::array();
  for (const Criterion& criterion : detection.criteria)
    json["criteria"].push_back({{"name", criterion.name},
                                {"value", criterion.value},
                                {"required", criterion.required},
                                {"upper_limit", criterion.upper_limit},
                                {"passed", criterion.passed()}});
  if (!detection.rejection.empty())
    json["rejection"] = detection.rejection;
  if (detection.undetermined_turn)
    json["undetermined_turn"] = toJson(*detection.undetermined_turn);
  return json;
}

void printDetections(std::ostream& out, const std::vector<Detection>& detections)
{
  std::size_t name_width = 4;
  for (const Detection& detection : detections)
    name_width = std::max(name_width, detection.part.size());
  out << "  #  " << std::left << std::setw(static_cast<int>(name_width)) << "part" << std::right
      << "  score  matching  visible  rms/mm   x/mm     y/mm     z/mm\n";
  for (std::size_t k = 0; k < detections.size(); ++k)
  {
    const Detection& d = detections[k];
    out << std::setw(3) << k + 1 << "  " << std::left << std::setw(static_cast<int>(name_width)) << d.part << std::right
        << std::setw(7) << roundedText(d.score, 3) << std::setw(10) << roundedText(d.matching_rate, 3) << std::setw(9)
        << roundedText(d.visible_fraction, 3) << std::setw(8) << roundedText(d.rms * 1000, 2);
    for (int axis = 0; axis < 3; ++axis)
      out << std::setw(axis == 0 ? 8 : 9) << roundedText(d.T_camera_object.translation()[axis] * 1000, 1);
    out << "\n";
  }
  for (std::size_t k = 0; k < detections.size(); ++k)
    if (detections[k].undetermined_turn)
      out << "  #" << k + 1 << ": " << describe(*detections[k].undetermined_turn) << "\n";
}
}  // namespace

nlohmann::json toJson(const Pose& T)
{
  Json rows = Json::array();
  for (int row = 0; row < 4; ++row)
    rows.push_back({T(row, 0), T(row, 1), T(row, 2), T(row, 3)});
  return rows;
}

nlohmann::json toJson(const UndeterminedTurn& turn)
{
  const auto vector = [](const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); };
  return {{"axis", {{"direction", vector(turn.axis.direction)}, {"origin", vector(turn.axis.origin)}}},
          {"angles", turn.angles},
          {"deviation", turn.deviation},
          {"text", describe(turn)}};
}

nlohmann::json toJson(const DetectionResult& result)
{
  Json json;
  json["code"] = static_cast<int>(result.code);
  json["message"] = result.message;
  json["partial"] = result.partial;
  json["detections"] = Json::array();
  for (const Detection& detection : result.detections)
    json["detections"].push_back(detectionJson(detection));
  json["rejected"] = Json::array();
  for (const Detection& detection : result.rejected)
    json["rejected"].push_back(detectionJson(detection));
  json["timing_ms"]["total"] = result.total_seconds * 1000;
  for (const StageTime& stage : result.timing)
    json["timing_ms"][stage.stage] = stage.seconds * 1000;
  json["counts"] = Json::object();
  for (const StageCount& stage : result.counts)
    json["counts"][stage.stage] = stage.count;
  return json;
}

void print(std::ostream& out, const DetectionResult& result)
{
  out << result.message << (result.partial ? " The deadline passed; this is what was ready." : "") << "\n";
  if (!result.detections.empty())
  {
    out << "\n";
    printDetections(out, result.detections);
  }
  if (!result.rejected.empty())
    out << "\nrejected (best first):\n";
  for (std::size_t k = 0; k < std::min(result.rejected.size(), PRINTED_REJECTIONS); ++k)
    out << "  " << result.rejected[k].part << ": " << result.rejected[k].rejection << "\n";
  if (result.rejected.size() > PRINTED_REJECTIONS)
    out << "  ... and " << result.rejected.size() - PRINTED_REJECTIONS << " more (--json lists them)\n";
  out << "\nstage                       ms\n";
  for (const StageTime& stage : result.timing)
    out << "  " << std::left << std::setw(18) << stage.stage << std::right << std::setw(10)
        << roundedText(stage.seconds * 1000, 1) << "\n";
  out << "  " << std::left << std::setw(18) << "total" << std::right << std::setw(10)
      << roundedText(result.total_seconds * 1000, 1) << "\n";
}
}  // namespace bin_picking::tools
