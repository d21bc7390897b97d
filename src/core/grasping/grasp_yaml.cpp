// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <locale>
#include <sstream>

#include "bin_picking_perception/common/figures.hpp"
#include "bin_picking_perception/grasping/grasp_proposal.hpp"

namespace bin_picking
{
std::string graspsToYaml(const std::vector<GraspDefinition>& grasps)
{
  std::ostringstream out;
  out.imbue(std::locale::classic());
  const auto list = [&](const Eigen::Vector3d& v, int digits) {
    return "[" + shortText(v.x(), digits) + ", " + shortText(v.y(), digits) + ", " + shortText(v.z(), digits) + "]";
  };
  out << "grasps:\n";
  for (const GraspDefinition& grasp : grasps)
  {
    out << "  - id: " << grasp.id << "\n    position: " << list(grasp.T_object_tip.translation(), 4)
        << "\n    approach: " << list(grasp.T_object_tip.linear().col(2), 5)
        << "\n    closing: " << list(grasp.T_object_tip.linear().col(1), 5)
        << "\n    width: " << shortText(grasp.width, 4) << "\n    opening: " << shortText(grasp.opening, 4)
        << "\n    approach_distance: " << shortText(grasp.approach, 3)
        << "\n    retreat_distance: " << shortText(grasp.retreat, 3) << "\n    priority: " << grasp.priority << "\n";
    if (!grasp.symmetric)
      out << "    symmetric: false\n";
    if (grasp.tilt_tolerance > 0)
      out << "    tilt_tolerance_deg: " << shortText(grasp.tilt_tolerance * 180 / M_PI, 1) << "\n";
    if (grasp.spin_tolerance > 0)
      out << "    spin_tolerance_deg: " << shortText(grasp.spin_tolerance * 180 / M_PI, 1) << "\n";
  }
  return out.str();
}
}  // namespace bin_picking
