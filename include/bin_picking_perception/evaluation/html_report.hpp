// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bin_picking_perception/evaluation/evaluation_summary.hpp"
#include "bin_picking_perception/evaluation/scene_picture.hpp"

namespace bin_picking
{
/// What a page shows.
struct EvaluationReport
{
  std::string title;                                         ///< of the data set
  std::vector<std::pair<std::string, std::string>> details;  ///< how it was made: name, value
  EvaluationParameters parameters;
  EvaluationSummary summary;
  std::vector<JudgedScene> scenes;
  std::vector<ScenePicture> pictures;  ///< one per scene
};

/// One page that needs nothing else: pictures inside, no network, light and dark.
/// \throws ParameterError not one picture per scene
std::string htmlReport(const EvaluationReport& report);
}  // namespace bin_picking
