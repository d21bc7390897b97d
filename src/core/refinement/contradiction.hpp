// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
/// What speaks against poses T_camera_object * turn: what was measured off the surface, and what of the surface the
/// sensor looked through. In squares of a leaf's edge: a point that is plainly wrong counts four and a half times the
/// area that it stands for. The model and the grids must outlive it.
class Contradiction
{
public:
  /// \param grid what belongs to parts; \param surroundings the same grid with the bin
  /// \param tolerance of the distance to the surface, metres
  Contradiction(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                const DepthGrid& surroundings, double tolerance);

  /// Of every turn. From here on, of the measured points only those count that lie near the surface of one of these
  /// poses at least: they may belong to the part. What is more than MOST_MARGIN above the least is only known to be so.
  std::vector<double> ofAll(const std::vector<Pose>& turns);

  double operator()(const Pose& turn) const;

private:
  struct Turn
  {
    std::size_t index;
    Eigen::Isometry3f T_turned_object;
    double off_surface;
  };

  double cost(float distance) const;
  /// Those that lag behind the best by more than that.
  static void dropHopeless(std::vector<Turn>& turns, double lag);
  /// Of points_ [begin, end). \param concerned receives those that lie near the surface of a turn
  void addOffSurface(std::size_t begin, std::size_t end, std::vector<Turn>& turns,
                     std::vector<Eigen::Vector3f>& concerned) const;
  /// \param enough where the search may end
  double seenThrough(const Pose& turn, double enough) const;

  const TrainedModel& model_;
  Pose T_camera_object_;
  const DepthGrid& surroundings_;
  double tolerance_;
  std::vector<Eigen::Vector3f> points_;  ///< measured around the pose, part frame
  double area_per_point_;                ///< in squares of a leaf's edge
};
}  // namespace bin_picking
