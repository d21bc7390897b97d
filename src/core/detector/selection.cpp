// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <iterator>

#include "bin_picking_perception/common/figures.hpp"
#include "stages.hpp"

namespace bin_picking
{
std::string failureText(const Criterion& criterion)
{
  return criterion.name + " is " + roundedText(criterion.value, 3) + ", but must be at " +
         (criterion.upper_limit ? "most " : "least ") + roundedText(criterion.required, 3);
}

void summarize(DetectionResult& result)
{
  const auto open = std::count_if(result.detections.begin(), result.detections.end(),
                                  [](const Detection& detection) { return detection.undetermined_turn.has_value(); });
  const std::string unknown = open > 0 ? "; the turn of " + std::to_string(open) + " of them is not known" : "";
  const std::string late = result.partial ? "; the deadline passed, so this is what was ready" : "";
  result.code = result.detections.empty() ? DetectionCode::NoMatch : DetectionCode::Ok;
  if (result.detections.empty())
    result.message = "no part was recognised; the best of " + std::to_string(result.rejected.size()) +
                     " rejected poses: " + (result.rejected.empty() ? "none" : result.rejected.front().rejection) +
                     late;
  else
    result.message = std::to_string(result.detections.size()) + " part(s) found, the best with a score of " +
                     roundedText(result.detections.front().score, 2) + unknown + late;
}

double sharedPart(const std::vector<int>& cells, const std::vector<int>& explained)
{
  std::size_t shared = 0;
  for (const int cell : cells)
    shared += std::binary_search(explained.begin(), explained.end(), cell) ? 1 : 0;
  return cells.empty() ? 0 : static_cast<double>(shared) / static_cast<double>(cells.size());
}

namespace
{
/// How much of the picture a pose can be expected to explain: all its cells if it is right, none if it is not. Wrong
/// poses fit well to the little that they explain and say that the rest is hidden.
double expectedCells(const Assessed& pose) { return pose.detection.score * static_cast<double>(pose.cells.size()); }

/// What is measured lies on one part: of accepted poses that explain the same, the one expected to explain most stays.
void rejectOverlapping(std::vector<Assessed>& poses, double max_overlap)
{
  std::stable_sort(poses.begin(), poses.end(),
                   [](const Assessed& a, const Assessed& b) { return expectedCells(a) > expectedCells(b); });
  std::vector<int> explained;  // ascending
  for (Assessed& pose : poses)
  {
    if (!pose.detection.rejection.empty())
      continue;
    const double overlap = sharedPart(pose.cells, explained);
    if (overlap > max_overlap)
    {
      pose.detection.rejection =
          "a detection that explains more explains " + roundedText(100 * overlap, 0) + " % of the same points";
      continue;
    }
    std::vector<int> merged;
    std::set_union(explained.begin(), explained.end(), pose.cells.begin(), pose.cells.end(),
                   std::back_inserter(merged));
    explained = std::move(merged);
  }
}
}  // namespace

void selectDetections(std::vector<Assessed> assessed, const DetectorParameters& parameters, DetectionResult& result)
{
  rejectOverlapping(assessed, parameters.verification.overlap);
  std::stable_sort(assessed.begin(), assessed.end(),
                   [](const Assessed& a, const Assessed& b) { return a.detection.score > b.detection.score; });
  for (Assessed& pose : assessed)
  {
    Detection& detection = pose.detection;
    if (detection.rejection.empty() && static_cast<int>(result.detections.size()) >= parameters.max_detections)
      detection.rejection = "max_detections better ones were found";
    if (detection.rejection.empty())
      result.detections.push_back(std::move(detection));
    else if (static_cast<int>(result.rejected.size()) < parameters.max_rejected)
      result.rejected.push_back(std::move(detection));
  }
}
}  // namespace bin_picking
