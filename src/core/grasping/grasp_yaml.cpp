// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>

#include "bin_picking_perception/grasping/grasp_proposal.hpp"

namespace bin_picking
{
std::string graspsToYaml(const std::vector<GraspDefinition>& grasps)
{
  std::ostringstream out;
  out.imbue(std::locale::classic());
  const auto number = [](double value, int digits) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << std::fixed << std::setprecision(digits) << (std::abs(value) < std::pow(10.0, -digits) / 2 ? 0.0 : value);
    std::string result = text.str();
    result.erase(result.find_last_not_of('0') + 1);
    if (result.back() == '.')
      result.pop_back();
    return result;
  };
  const auto list = [&](const Eigen::Vector3d& v, int digits) {
    return "[" + number(v.x(), digits) + ", " + number(v.y(), digits) + ", " + number(v.z(), digits) + "]";
  };
  out << "grasps:\n";
  for (const GraspDefinition& grasp : grasps)
  {
    out << "  - id: " << grasp.id << "\n    position: " << list(grasp.T_object_tip.translation(), 4)
        << "\n    approach: " << list(grasp.T_object_tip.linear().col(2), 5)
        << "\n    closing: " << list(grasp.T_object_tip.linear().col(1), 5) << "\n    width: " << number(grasp.width, 4)
        << "\n    opening: " << number(grasp.opening, 4) << "\n    approach_distance: " << number(grasp.approach, 3)
        << "\n    retreat_distance: " << number(grasp.retreat, 3) << "\n    priority: " << grasp.priority << "\n";
    if (!grasp.symmetric)
      out << "    symmetric: false\n";
    if (grasp.tilt_tolerance > 0)
      out << "    tilt_tolerance_deg: " << number(grasp.tilt_tolerance * 180 / M_PI, 1) << "\n";
    if (grasp.spin_tolerance > 0)
      out << "    spin_tolerance_deg: " << number(grasp.spin_tolerance * 180 / M_PI, 1) << "\n";
  }
  return out.str();
}
}  // namespace bin_picking
