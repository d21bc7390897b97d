// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <functional>
#include <string>

#include "bin_picking_perception/model/trained_model.hpp"

namespace bin_picking
{
class Executor;

/// The first half of training: parameters with the part's own and every automatic length, mesh, size, surface, views,
/// and what the surface says of itself (compareWithItself). \param report called with a stage name now and then
/// \return the whole surface, dense enough for normals and curvature
OrientedPoints learnShape(TrainedModel& model, const PartDefinition& definition, const TrainingParameters& parameters,
                          const Executor& executor, const std::function<void(const std::string&)>& report);
}  // namespace bin_picking
