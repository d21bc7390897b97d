// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <chrono>

namespace bin_picking
{
/// A point in time by which an answer is wanted. Cheap to ask.
class Deadline
{
public:
  using Clock = std::chrono::steady_clock;

  /// Never passes.
  Deadline() = default;
  /// \param seconds from now; 0 or less: never
  explicit Deadline(double seconds)
      : end_(seconds > 0
                 ? Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds))
                 : Clock::time_point::max())
  {}
  bool passed() const { return end_ != Clock::time_point::max() && Clock::now() >= end_; }

private:
  Clock::time_point end_ = Clock::time_point::max();
};
}  // namespace bin_picking
