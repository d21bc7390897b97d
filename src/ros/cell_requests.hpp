// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <bin_picking_perception/Grip.h>
#include <bin_picking_perception/TakePart.h>

namespace bin_picking_ros
{
/// What can be told without the cell. \throws RequestError INVALID_ARGUMENT: select or tolerance make no sense
void checkRequest(const bin_picking_perception::TakePart::Request& request);
/// \throws RequestError INVALID_ARGUMENT: opening or width are not finite
void checkRequest(const bin_picking_perception::Grip::Request& request);
}  // namespace bin_picking_ros
