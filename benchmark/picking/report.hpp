// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_emptying.hpp"

namespace bin_picking::picking
{
/// All bins with one filling.
struct PartStudy
{
  std::string name;  ///< of the part, or "mixed"
  std::vector<Emptying> bins;
};

struct Study
{
  std::vector<std::string> command;
  std::string version;  ///< of the sources, as the caller says; may be empty
  std::string sensor;
  std::string gripper;
  bool truth = false;
  std::vector<PartStudy> parts;
};

/// What went wrong with an attempt, in a few words that can be counted: "approach: gripper, part"; "taken" if nothing.
std::string causeOf(const Attempt& attempt);

/// Markdown.
std::string toText(const Study& study);
/// Every attempt.
std::string toJson(const Study& study);
}  // namespace bin_picking::picking
