// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/icp.hpp"

namespace bin_picking
{
void IcpParameters::visit(ParameterVisitor& v)
{
  v.field({"method", "",
           "point_to_point with nearest neighbours (the paper), measured points against the distance_field of the "
           "part, or none"},
          method,
          {{"none", IcpMethod::None},
           {"point_to_point", IcpMethod::PointToPoint},
           {"distance_field", IcpMethod::DistanceField}});
  v.field({"max_iterations", "", "ends the refinement if it has not converged before", 1, 1000}, max_iterations);
  v.field({"max_distance", "", "pairs further apart than this many leaves are not used at the start", 0.1, 20},
          max_distance);
  v.field({"min_distance", "", "and at the end; small values reject the neighbouring part's surface", 0.05, 20},
          min_distance);
  v.field({"max_normal_angle", "rad", "pairs whose normals differ by more are not used", 0.05, 3.2}, max_normal_angle);
  v.field({"convergence", "m", "the refinement ends when the surface moves less than this in an iteration", 1e-9, 1e-3},
          convergence);
  v.field(
      {"error_spacing", "",
       "pixels of the sensor over which the errors of its depths are about alike; 0, or less than some pixels of the "
       "working grid: taken for independent; where they are not, poses then err by a third more",
       0, 200},
      error_spacing);
}
}  // namespace bin_picking
