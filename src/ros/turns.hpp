// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>

namespace bin_picking_ros
{
/// One at a time, in the order of asking. A plain mutex would let a thread that asks again at once, such as continuous
/// processing, pass all others for ever.
class Turns
{
public:
  using Clock = std::chrono::steady_clock;

  /// While it lives, it is its holder's turn.
  class Turn
  {
  public:
    ~Turn();
    Turn(Turn&& other) noexcept;
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
    Turn& operator=(Turn&&) = delete;

    /// False: the time was up, or the queue was closed.
    explicit operator bool() const { return turns_ != nullptr; }

  private:
    friend class Turns;
    explicit Turn(Turns* turns) : turns_(turns) {}
    Turns* turns_;
  };

  /// Waits for a turn, at most until then.
  Turn wait(Clock::time_point until);

  /// Ends all waiting, now and in future; who has a turn keeps it.
  void close();

private:
  void release();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::uint64_t> queue_;  ///< tickets; the first one has its turn
  std::uint64_t next_ticket_ = 0;
  bool closed_ = false;
};
}  // namespace bin_picking_ros
