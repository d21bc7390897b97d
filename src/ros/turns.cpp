// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "turns.hpp"

#include <algorithm>
#include <utility>

namespace bin_picking_ros
{
Turns::Turn::~Turn()
{
  if (turns_)
    turns_->release();
}

Turns::Turn::Turn(Turn&& other) noexcept : turns_(std::exchange(other.turns_, nullptr)) {}

Turns::Turn Turns::wait(Clock::time_point until)
{
  std::unique_lock<std::mutex> lock(mutex_);
  const std::uint64_t ticket = next_ticket_++;
  queue_.push_back(ticket);
  const bool in_time = changed_.wait_until(lock, until, [&] { return closed_ || queue_.front() == ticket; });
  if (in_time && !closed_)
    return Turn(this);
  queue_.erase(std::find(queue_.begin(), queue_.end(), ticket));
  changed_.notify_all();  // the one behind may be first now
  return Turn(nullptr);
}

void Turns::close()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

void Turns::release()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    queue_.pop_front();
  }
  changed_.notify_all();
}
}  // namespace bin_picking_ros
