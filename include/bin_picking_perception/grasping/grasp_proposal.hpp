// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/grasping/grasp_check.hpp"

namespace bin_picking
{
/// Share of all attitudes in which a part may lie that have a grasp whose approach is tilted by no more than `max_tilt`
/// (rad) from straight down: over directions spread evenly, to about 0.5 %. What lies beside the part is not looked at.
double attitudeCoverage(const std::vector<GraspVariant>& variants, double max_tilt);

/// Grasps between opposed faces of a part, each good after GraspChecker, best first.
///
/// Points drawn from the surface (seeded) are joined with what lies opposite along their normals, if its normal is
/// opposed within the cone of friction and the gripper is wide enough. Around each such axis approaches are tried every
/// 30 degrees, centred and measured with the pads. Chosen one after the other is what adds most attitudes (with its
/// symmetric copies and a tilt tolerance of up to 30 degrees, if that holds), weighted with contact area and nearness
/// to the middle of the part, and down to half the wider the gripper has to open. \return at most `count`; fewer if
/// there are no more that add an attitude \throws ParameterError count < 1, or as GraspChecker
std::vector<GraspDefinition> proposeGrasps(const PartDefinition& part, const TriangleMesh& mesh, const Gripper& gripper,
                                           const GraspCheckParameters& parameters, int count, const Executor& executor);

/// The grasps as the `grasps:` of a part.yaml.
std::string graspsToYaml(const std::vector<GraspDefinition>& grasps);
}  // namespace bin_picking
