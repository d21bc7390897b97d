// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

namespace bin_picking
{
/// Without std::floor, which is a call where the processor's own instruction may not be taken for granted.
/// \pre the result fits an int
inline int roundedDown(float value)
{
  const int towards_zero = static_cast<int>(value);
  return towards_zero - (value < static_cast<float>(towards_zero) ? 1 : 0);
}
}  // namespace bin_picking
