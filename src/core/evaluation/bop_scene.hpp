// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bin_picking_perception/evaluation/evaluation_dataset.hpp"

namespace bin_picking
{
/// The file that makes a folder a scene with known poses.
constexpr const char* BOP_TRUTH = "scene_gt.json";

/// Objects that are searched for in an image, by the ids of its scene and of itself; empty: whatever is annotated.
using BopTargets = std::map<std::pair<int, int>, std::set<int>>;

std::string bopPartName(int object_id);

/// The images of a scene folder that are targets, by number. \throws FileError
std::vector<EvaluationScene> readBopScene(const std::filesystem::path& folder, const BopTargets& targets);
}  // namespace bin_picking
