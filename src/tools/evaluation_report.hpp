// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <nlohmann/json.hpp>
#include <ostream>
#include <vector>

#include "bin_picking_perception/evaluation/evaluation_summary.hpp"

namespace bin_picking::tools
{
/// Every figure, every scene, every pose with its verdict.
nlohmann::json toJson(const EvaluationSummary& summary);
nlohmann::json toJson(const JudgedScene& scene);

/// For people: a table with a line per part, then the figures of all with their intervals, then the times.
void print(std::ostream& out, const EvaluationSummary& summary);
}  // namespace bin_picking::tools
