// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/grasping/grasp_check.hpp"

namespace bin_picking
{
/// A grasp to be drawn, with what the check said.
struct DrawnGrasp
{
  GraspDefinition grasp;
  GraspCheck check;
};

/// One picture with a tile per grasp: the part held by the gripper (fingers at the width, pads orange), seen from aside
/// with the approach pointing down; the parts of the fingers that are cut by the part are not seen. A bad grasp has its
/// name in red, with the first fault, and a red mark where the open gripper would cut the part.
/// \throws FileError cannot be written \throws ParameterError no grasps
void saveGraspPicture(const TriangleMesh& mesh, const Gripper& gripper, const std::vector<DrawnGrasp>& grasps,
                      const std::string& path);
}  // namespace bin_picking
