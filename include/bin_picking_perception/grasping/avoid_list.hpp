// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "bin_picking_perception/common/parameters.hpp"

namespace bin_picking
{
/// How long a place is left alone after an attempt that failed there.
struct AvoidParameters
{
  double radius = 0.02;
  double duration = 120;
  int picks = 3;
  double duration_not_attempted = 15;

  void visit(ParameterVisitor& v);
};

/// What became of an attempt to take a part.
enum class PickOutcome
{
  Picked,       ///< the part is out of the bin
  Missed,       ///< the gripper closed on nothing
  Dropped,      ///< held, then lost
  Collision,    ///< the robot touched something and stopped
  NotAttempted  ///< the robot did not try
};

/// "picked", "missed", ... for logs and messages.
const char* toString(PickOutcome outcome);

/// A place where the last attempt failed.
struct AvoidedPlace
{
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< middle of the part that was meant, fixed frame, metres
  double radius = 0;                                 ///< metres
  double since = 0;                                  ///< seconds, the caller's clock
  double until = 0;                                  ///< seconds
  int picks_left = 0;                                ///< successful picks after which the pile counts as another one
  PickOutcome outcome = PickOutcome::Missed;
  std::string part;
};

/// Places whose parts are not offered for a while, because an attempt to take them failed: the same view would else
/// give the same grasp, and the robot would try it for ever.
///
/// A place is forgotten after a time, after some successful picks anywhere (the pile has changed, and with it what was
/// in the way), at once by a successful pick within its radius, or when clear() is called. An attempt that was not made
/// changes nothing in the bin: its place is forgotten sooner, so that other parts come first and this one again.
/// A failure within the radius of an older one replaces it, but an attempt that was not made does not replace one that
/// lasts longer. There are never more than MAX_PLACES, the oldest gives way.
///
/// Knows neither clock nor frames: times are the caller's, any that do not run backwards; centres are in one frame in
/// which the bin stands still (the bin's or the robot's, not that of a camera on the arm). The same calls give the same
/// list. Not thread-safe.
class AvoidList
{
public:
  static constexpr std::size_t MAX_PLACES = 256;

  /// \throws ParameterError a value is out of its range
  explicit AvoidList(const AvoidParameters& parameters);

  /// \param center of the part that was meant \param now seconds \throws ParameterError not finite
  void report(PickOutcome outcome, const Eigen::Vector3d& center, double now, const std::string& part = "");

  /// Forgets what has expired by now. A clock that was set back (places from the future) expires them too.
  void tick(double now);

  /// The newest place that a point lies in, its rim included; nullptr: none. Holds until the next change of the list.
  const AvoidedPlace* find(const Eigen::Vector3d& point) const;
  bool contains(const Eigen::Vector3d& point) const { return find(point) != nullptr; }

  /// Oldest first.
  const std::vector<AvoidedPlace>& places() const { return places_; }
  void clear() { places_.clear(); }

private:
  void forgetNear(const Eigen::Vector3d& center);
  bool lastsNear(const Eigen::Vector3d& center, double until) const;

  AvoidParameters parameters_;
  std::vector<AvoidedPlace> places_;
};
}  // namespace bin_picking
