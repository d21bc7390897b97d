// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <chrono>
#include <string>

namespace bin_picking::tools
{
class Stopwatch
{
public:
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// One line on the terminal that says what is being done; silent when the error stream is not a terminal. The line is
/// wiped at the end, also by the destructor.
class Progress
{
public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(const std::string& stage);
  /// Wipes the line.
  void finish();

private:
  bool on_terminal_;
  Stopwatch watch_;
};

/// The whole text of a file. \throws FileError
std::string readText(const std::string& path);

/// The whole file or nothing of it. \throws FileError
void writeText(const std::string& path, const std::string& text);
}  // namespace bin_picking::tools
