// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "arguments.hpp"

namespace bin_picking::tools
{
/// A sub-command. `run` throws the core's errors and UsageError; main turns them into exit codes.
struct Command
{
  Syntax syntax;
  void (*run)(const Arguments&);
};

Command trainCommand();
Command detectCommand();
Command matchCommand();
Command evaluateCommand();
Command simulateCommand();
Command graspsCommand();
Command parametersCommand();
}  // namespace bin_picking::tools
