// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <chrono>
#include <string>

#include "bin_picking_perception/detector.hpp"

namespace bin_picking
{
/// Writes the time since the last lap into the result, under a stage's name; laps of one name add up.
class StageClock
{
public:
  explicit StageClock(DetectionResult& result) : result_(result), start_(Clock::now()), lap_(start_) {}

  void lap(const std::string& stage)
  {
    const auto now = Clock::now();
    add(stage, std::chrono::duration<double>(now - lap_).count());
    lap_ = now;
  }
  void count(const std::string& stage, double number)
  {
    for (auto& entry : result_.counts)
      if (entry.stage == stage)
      {
        entry.count += number;
        return;
      }
    result_.counts.push_back({stage, number});
  }
  void finish() { result_.total_seconds = std::chrono::duration<double>(Clock::now() - start_).count(); }

private:
  using Clock = std::chrono::steady_clock;

  void add(const std::string& stage, double seconds)
  {
    for (auto& entry : result_.timing)
      if (entry.stage == stage)
      {
        entry.seconds += seconds;
        return;
      }
    result_.timing.push_back({stage, seconds});
  }

  DetectionResult& result_;
  Clock::time_point start_;
  Clock::time_point lap_;
};
}  // namespace bin_picking
