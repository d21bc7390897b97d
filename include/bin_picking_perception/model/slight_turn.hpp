// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/model/trained_model.hpp"

namespace bin_picking
{
/// Farthest motion of the part's box corners from one pose to the other, modulo its symmetry, metres.
double farthestMotion(const TrainedModel& model, const Pose& a, const Pose& b);

/// The angle of a turn whose axis is parallel to the given one, about that, rad, [0, 2 pi).
double angleAbout(const Symmetry::Axis& axis, const Pose& turn);

/// The slight near symmetry that a motion of the part's frame is, modulo the part's symmetry; nullptr if it is none.
const NearSymmetry* slightTurn(const TrainedModel& model, const Pose& T_object_object);

/// The slight near symmetries as sentences, for people.
std::vector<std::string> describeSlightTurns(const TrainedModel& model);
}  // namespace bin_picking
