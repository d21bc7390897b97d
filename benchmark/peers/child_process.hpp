// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <functional>
#include <string>

namespace bin_picking::peers
{
using LineSink = std::function<void(const std::string& line)>;

/// Runs the task in a process of its own: a crash or an endless loop ends there and its memory is its own. What the
/// task emits arrives at `receive`, line by line, while it runs. The caller must have no threads of its own.
/// \param seconds_per_line CPU time after which a line must have come, else the process is ended; so it is if ten times
///   as long passes on the clock
/// \return empty, or why it did not finish: "crashed (Segmentation fault)", "no result within 60 s", what() of an
///   exception
std::string runInChild(const std::function<void(const LineSink& emit)>& task, double seconds_per_line,
                       const LineSink& receive);
}  // namespace bin_picking::peers
