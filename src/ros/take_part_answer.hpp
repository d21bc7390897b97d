// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <bin_picking_perception/TakePart.h>

#include <cstddef>
#include <string>

#include "pickable_cell.hpp"
#include "return_code.hpp"

namespace bin_picking_ros
{
using TakePartResponse = bin_picking_perception::TakePart::Response;

/// "1 part", "2 parts"
std::string partsText(std::size_t count);

/// \param id that was asked for
TakePartResponse toAnswer(const PickOutcome& outcome, int id);

/// No part lies at the request's pose.
TakePartResponse nothingThere(const bin_picking_perception::TakePart::Request& request, std::size_t num_left);

/// What kept the request from being carried out.
TakePartResponse failedAnswer(const ReturnCode& code);
}  // namespace bin_picking_ros
