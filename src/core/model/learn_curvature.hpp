// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "part_views.hpp"

namespace bin_picking
{
/// What a large curvature is in the unit of the measure: 1 / curvature radius, or 1 for the normal variation.
double curvatureScale(const TrainingParameters& parameters);

/// Fills the curvature of the model's points, settles whether `auto` uses it, and remarks why.
/// \param dense the whole surface. \param views of the part; none: curvature is taken all around. \return number of
/// curvature bins, if no step is given
int learnCurvature(TrainedModel& model, const OrientedPoints& dense, const std::vector<PartView>& views,
                   const Executor& executor);
}  // namespace bin_picking
