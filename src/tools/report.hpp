// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <nlohmann/json.hpp>
#include <ostream>
#include <string>

#include "bin_picking_perception/detector.hpp"

namespace bin_picking::tools
{
/// T as four rows of four numbers, metres.
nlohmann::json toJson(const Pose& T);

nlohmann::json toJson(const UndeterminedTurn& turn);

/// The form that other programs read. Files and their loading times are for the caller to add.
nlohmann::json toJson(const DetectionResult& result);

/// For people: the message, a table of the detections, why others were rejected, the stages.
void print(std::ostream& out, const DetectionResult& result);
}  // namespace bin_picking::tools
