// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <memory>
#include <vector>

#include "arguments.hpp"
#include "bin_picking_perception/evaluation/evaluation_dataset.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "terminal.hpp"

namespace bin_picking::tools
{
/// A model for every part of the data set: those of --model, or trained with the training parameters of --config and
/// kept in the folder of --cache. \throws UsageError a part without --model; FileError
std::vector<std::shared_ptr<const TrainedModel>> modelsFor(const EvaluationDataset& dataset, const Arguments& arguments,
                                                           Progress& progress);
}  // namespace bin_picking::tools
