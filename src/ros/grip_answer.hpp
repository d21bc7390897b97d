// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <bin_picking_perception/Grip.h>

#include <optional>

#include "pickable_cell.hpp"
#include "return_code.hpp"

namespace bin_picking_ros
{
using GripResponse = bin_picking_perception::Grip::Response;

/// \param meant id of the part that the request means; nothing: it did not say, or none lies there
GripResponse toAnswer(const GripOutcome& outcome, const std::optional<int>& meant);

/// What kept the grip from being made.
GripResponse failedGrip(const ReturnCode& code);
}  // namespace bin_picking_ros
