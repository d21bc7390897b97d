// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
/// "z through (0.00, 0.00, 0.00) mm", or "(0.6000, 0.0000, 0.8000) through ..." for an axis that is none of the
/// drawing's.
std::string axisText(const Symmetry::Axis& axis);
}  // namespace bin_picking
