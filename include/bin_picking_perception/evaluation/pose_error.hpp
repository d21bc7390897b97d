// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "bin_picking_perception/model/undetermined_turn.hpp"

namespace bin_picking
{
/// How far an estimated pose is from the truth, modulo the part's symmetry.
struct PoseError
{
  double translation = 0;  ///< of the reference point, metres
  double rotation = 0;     ///< rad, [0, pi]
};

/// Compares with the symmetric equivalent of the estimate that is nearest to the truth in rotation.
/// \param center point of the part at which the translation is compared, part frame: its middle, so that a rotation
/// error
///   does not count as translation (for a part with an axis of revolution: a point on the axis)
PoseError poseError(const Pose& estimate, const Pose& truth, const Symmetry& symmetry,
                    const Eigen::Vector3d& center = Eigen::Vector3d::Zero());

/// Mean distance of corresponding points, metres (ADD; Hinterstoisser et al. 2012). For parts without symmetry.
/// \param points of the part's surface, part frame. \throws ParameterError no points
double averageDistance(const std::vector<Eigen::Vector3f>& points, const Pose& estimate, const Pose& truth);

/// Mean distance from each point at the true pose to the nearest one at the estimate, metres (ADD-S). Blind to any
/// symmetry, and lenient: dense surfaces that slide along themselves hardly count.
/// \throws ParameterError no points
double averageNearestDistance(const std::vector<Eigen::Vector3f>& points, const Pose& estimate, const Pose& truth);

/// Largest distance of corresponding points, minimised over the part's symmetry, metres (MSSD; Hodan et al. 2020): the
/// one number that tells whether a gripper built for the part will fit. \param steps samples of a continuous axis: at a
/// distance r from it the value is too large by at most pi r / steps \throws ParameterError no points, or fewer than
/// one step
double maximumSymmetryAwareDistance(const std::vector<Eigen::Vector3f>& points, const Pose& estimate, const Pose& truth,
                                    const Symmetry& symmetry, int steps = 360);

/// The same for an estimate that leaves a turn open: minimised over that turn and the symmetry.
double maximumSymmetryAwareDistance(const std::vector<Eigen::Vector3f>& points, const Pose& estimate, const Pose& truth,
                                    const Symmetry& symmetry, const UndeterminedTurn& turn, int steps = 360);
}  // namespace bin_picking
