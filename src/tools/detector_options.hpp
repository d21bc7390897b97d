// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/detector_parameters.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/model/training_parameters.hpp"

namespace bin_picking::tools
{
/// The options that all commands with a detector share: --preset, --config, --threads, --set.
std::vector<Option> detectorOptions();

/// The preset, changed by the configuration file, then by --threads, then by --set.
DetectorParameters detectorParameters(const Arguments& arguments);

/// The groups of a configuration file. One file may serve training and detection: each takes its own group, and the
/// other is checked all the same.
struct Configuration
{
  TrainingParameters training;
  DetectorParameters detector;

  void visit(ParameterVisitor& v);
};

/// --config, if it was given. \throws FileError, ParameterError
void applyConfigFile(const Arguments& arguments, Configuration& configuration);
/// --set. \throws ParameterError
void applyAssignments(const Arguments& arguments, const VisitFunction& visit);

std::vector<std::shared_ptr<const TrainedModel>> loadModels(const std::vector<std::string>& paths);
}  // namespace bin_picking::tools
