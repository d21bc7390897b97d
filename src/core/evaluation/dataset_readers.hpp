// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <filesystem>
#include <string>

#include "bin_picking_perception/evaluation/evaluation_dataset.hpp"

namespace bin_picking
{
/// False also for what may not be looked at.
bool isThere(const std::filesystem::path& path);

/// Whether the folder holds scenes of the own format, or is one.
bool isOwnDataset(const std::string& path);
bool isBopDataset(const std::string& path);

/// Both leave the parts out that are not selected; the scenes are cut to max_scenes by openDataset.
EvaluationDataset openOwnDataset(const std::string& path, const DatasetSelection& selection);
EvaluationDataset openBopDataset(const std::string& path, const DatasetSelection& selection);

/// The definition that a value of the selection gives for a part, if one of them is a folder that describes it.
std::optional<PartDefinition> selectedDefinition(const std::string& part, const DatasetSelection& selection);

/// Of all parts that a data set knows, those that are selected. \throws ParameterError a value names none of them
std::vector<std::string> selectedParts(const std::vector<std::string>& known, const DatasetSelection& selection);

/// Forgets what is not selected: parts, their instances, and scenes that are left without any part.
void keepParts(std::vector<EvaluationScene>& scenes, const std::vector<std::string>& selected);

/// A 16-bit picture as a grid; 0 is not measured. \throws FileError
DepthGrid loadDepthImage(const std::string& path, const DepthImageFormat& format);
}  // namespace bin_picking
