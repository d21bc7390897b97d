// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/evaluation/evaluation_dataset.hpp"

namespace bin_picking::peers
{
/// Scans of one part in the air, in seeded attitudes, by the virtual structured-light sensor; written into `folder` as
/// PREFIX_<k>.pcd. Starts threads: call it in a process of its own. \return their truth
std::vector<EvaluationScene> makeViews(const PartDefinition& part, int count, std::uint32_t seed,
                                       const std::string& folder, const std::string& prefix);

/// One scan each of so many copies of the part side by side.
std::vector<EvaluationScene> makeGroups(const PartDefinition& part, const std::vector<int>& copies, std::uint32_t seed,
                                        const std::string& folder, const std::string& prefix);
}  // namespace bin_picking::peers
