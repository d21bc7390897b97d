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

void selectDetections(std::vector<Assessed> assessed, const DetectorParameters& parameters, DetectionResult& result)
{
  std::stable_sort(assessed.begin(), assessed.end(),
                   [](const Assessed& a, const Assessed& b) { return a.detection.score > b.detection.score; });
  std::vector<int> explained;  // by accepted detections, ascending
  for (auto& candidate : assessed)
  {
    Detection& detection = candidate.detection;
    const double overlap = detection.rejection.empty() ? sharedPart(candidate.cells, explained) : 0;
    if (detection.rejection.empty() && overlap > parameters.verification.overlap)
      detection.rejection = "a better detection explains " + roundedText(100 * overlap, 0) + " % of what it explains";
    if (detection.rejection.empty() && static_cast<int>(result.detections.size()) >= parameters.max_detections)
      detection.rejection = "max_detections better ones were found";
    if (!detection.rejection.empty())
    {
      if (static_cast<int>(result.rejected.size()) < parameters.max_rejected)
        result.rejected.push_back(std::move(detection));
      continue;
    }
    std::vector<int> merged;
    std::set_union(explained.begin(), explained.end(), candidate.cells.begin(), candidate.cells.end(),
                   std::back_inserter(merged));
    explained = std::move(merged);
    result.detections.push_back(std::move(detection));
  }
}
}  // namespace bin_picking
