// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"

namespace bin_picking
{
/// What the scene's own code measures of a part in one rendered view.
struct PartView
{
  std::vector<std::size_t> points;  ///< of TrainedModel::points: those that the view sees
  SceneSamples samples;             ///< one per such point, camera frame, with curvature if it is taken from views
  OrientedPoints edges;             ///< edgePoints, part frame, if training stores pairs with them
};

/// Views from all around, so many that each has a bit of 64. \param model its mesh, points, normals and parameters are
/// used; without a mesh there is no view
std::vector<PartView> measureViews(const TrainedModel& model, const Executor& executor);
}  // namespace bin_picking
