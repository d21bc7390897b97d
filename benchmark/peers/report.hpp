// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "figures.hpp"

namespace bin_picking::peers
{
/// All that was run. Trials of one part lie side by side, one per program.
struct Study
{
  std::vector<std::string> command;  ///< line with which it was asked for
  double step = 0;                   ///< sampling of the programs that do not derive their own
  double limit = 0;                  ///< seconds
  std::vector<PlannedTrial> lone;    ///< one part in the air
  std::vector<PlannedTrial> model_growth;
  std::vector<PlannedTrial> scene_growth;
  std::vector<PlannedTrial> bins;
  PartShapes shapes;      ///< of the given parts
  PartShapes bin_shapes;  ///< of the data set's
};

/// One page for people: what was compared, how, and the tables.
std::string toMarkdown(const Study& study);

/// Every pose and every figure, for programs.
nlohmann::json toJson(const Study& study);
}  // namespace bin_picking::peers
