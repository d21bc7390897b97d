// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <vector>

#include "bin_picking_perception/model/trained_model.hpp"

namespace bin_picking
{
/// A pose with where it takes the part's middle: most places are told apart by that.
struct Place
{
  Pose T_camera_object;
  Eigen::Vector3d center;
};

/// Near symmetries that two poses may differ by.
enum class Turns
{
  None,
  Slight,
  All
};

/// The same place and the same turn, modulo the part's symmetry and some of its near symmetries. The model must outlive
/// it.
class SamePlace
{
public:
  SamePlace(const TrainedModel& model, Turns turns);

  Place of(const Pose& T_camera_object) const { return {T_camera_object, T_camera_object * model_.center}; }

  bool operator()(const Place& a, const Place& b) const;

  /// Whether it is the same as any of others.
  bool isAmong(const std::vector<Place>& others, const Place& place) const;

private:
  void add(const Pose& turn);
  bool isSameTurn(const Pose& a, const Pose& b) const;

  const TrainedModel& model_;
  double near_enough_;
  double reach_ = 0;          ///< of the centres of what may be the same place
  std::vector<Place> turns_;  ///< none and others, in the part's frame
};
}  // namespace bin_picking
