// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/model/part.hpp"

namespace bin_picking::paper
{
using Json = nlohmann::json;

/// How a scene is searched: a row of a table.
struct Method
{
  std::string name;
  TrainingParameters training;
  DetectorParameters detector;
  bool part_training = false;  ///< the part's own training values hold over these
  bool true_segments = false;  ///< the true outlines in place of a segmentation
};

/// {"name", "preset", "config": YAML with training and detector, "training": {key: value}, "detector": {key: value},
/// "part_training", "segments": "true"}; all but the name may be left away. \throws ParameterError, FileError
Method readMethod(const Json& json);

/// Trains a part for every method once; methods that train alike share the model.
class Models
{
public:
  /// \param folder keeps trained models from run to run; empty: nowhere
  Models(const Executor& executor, std::string folder) : executor_(executor), folder_(std::move(folder)) {}
  std::shared_ptr<const TrainedModel> get(const PartDefinition& part, const Method& method);

private:
  const Executor& executor_;
  std::string folder_;
  std::map<std::string, std::shared_ptr<const TrainedModel>> models_;
};

/// What of a model explains its figures: points, pairs, bins of the curvature, share of weighted pairs, ...
Json describe(const TrainedModel& model);

/// Sum over all regions of what a stage counted.
double countOf(const DetectionResult& result, const std::string& stage);

/// Processor time of this program, seconds: other load on the machine disturbs it less than the time of day.
double processorSeconds();
}  // namespace bin_picking::paper
