// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/common/parameters.hpp"

namespace bin_picking::simulation
{
struct PhysicsParameters
{
  double friction = 0.35;
  double restitution = 0.05;
  double drop_height = 0.03;
  double drop_interval = 0.1;
  double time_step = 0.005;
  double max_settling_time = 3;

  void visit(ParameterVisitor& v);
};
}  // namespace bin_picking::simulation
