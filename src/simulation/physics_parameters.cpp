// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "physics_parameters.hpp"

namespace bin_picking::simulation
{
void PhysicsParameters::visit(ParameterVisitor& v)
{
  v.field({"friction", "", "of part on part and part on bin; more makes steeper piles", 0, 1.5}, friction);
  v.field({"restitution", "", "bounciness; more takes longer to come to rest", 0, 0.9}, restitution);
  v.field({"drop_height", "m", "free space below a part when it is let go", 0, 0.5}, drop_height);
  v.field({"drop_interval", "s", "between one part and the next", 0.02, 2}, drop_interval);
  v.field({"time_step", "s", "of the integration; shorter is slower and lets parts overlap less", 0.0005, 0.01},
          time_step);
  v.field({"max_settling_time", "s", "simulated time after which the last movement is stopped", 1, 60},
          max_settling_time);
}
}  // namespace bin_picking::simulation
