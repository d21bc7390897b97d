// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "part_views.hpp"

namespace bin_picking
{
/// The edges of a part's faces from what views of it show, and which of its points can be seen together with them.
/// Fills `edges` and `edge_table` of the model. \param model its `points` and `table` are used
void learnEdges(TrainedModel& model, const std::vector<PartView>& views, const Executor& executor);
}  // namespace bin_picking
