// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <functional>
#include <limits>
#include <optional>

#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/model/undetermined_turn.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
/// Margins of rivals are exact up to this: beyond it, more is not surer.
constexpr double MOST_MARGIN = 100;

/// A pose held against those that its part's near symmetries make of it.
struct RivalChoice
{
  Pose T_camera_object = Pose::Identity();  ///< the one that the scene contradicts least
  bool turned = false;                      ///< it is another than the given one
  /// By how much the scene contradicts the best pose that is truly another one (its surface elsewhere by more than a
  /// tenth of the diameter) more than this one, in squares of a leaf's edge; infinity: there is none. Near 0 the view
  /// cannot tell.
  double margin = std::numeric_limits<double>::infinity();
  /// Slight turns (slight_turn.hpp) about one axis that the view cannot tell from this pose; nothing if it can.
  std::optional<UndeterminedTurn> undetermined_turn;
  /// The margin against the rivals that these turns do not lead to; the same as `margin` if there are none.
  double margin_beyond_turn = std::numeric_limits<double>::infinity();
};

/// The rivals that come nearest are refined before they are judged: a wrong pose was refined to where it explains most,
/// from where a turn leads beside the right one.
/// \param T_camera_object refined. \param refine does with a pose what was done with that one, so that they compare
/// \param tolerance of the distance to the surface, metres
/// \param min_margin smaller ones cannot be told apart
/// \param grid what belongs to parts; \param surroundings the same grid with the bin
RivalChoice chooseAmongRivals(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                              const DepthGrid& surroundings, double tolerance, double min_margin,
                              const std::function<Pose(const Pose&)>& refine);

/// Of the measured points that lie near the part's surface at the pose, the share that lies on it; 0 if none is near. A
/// part of another shape explains much of the surface it was laid on, but leaves points beside it.
/// \param tolerance of the distance to the surface, metres
double surfaceShare(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid, double tolerance);
}  // namespace bin_picking
