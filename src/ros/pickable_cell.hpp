// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "grip_trial.hpp"
#include "random.hpp"
#include "virtual_cell.hpp"
#include "virtual_cell_parameters.hpp"

namespace bin_picking_ros
{
/// What became of an attempt to take a part.
struct PickOutcome
{
  enum class Kind
  {
    Taken,
    Missed,
    DroppedBack,
    NoSuchPart
  };
  Kind kind = Kind::NoSuchPart;
  int id = -1;       ///< of the part that was meant; -1: none
  std::string part;  ///< its name
  std::size_t num_left = 0;
};

/// What became of a grip with the mounted gripper.
struct GripOutcome
{
  bin_picking::simulation::GripVerdict verdict;
  PickOutcome::Kind kind = PickOutcome::Kind::Missed;  ///< has no meaning after a collision
  std::string part;                                    ///< name of verdict.id; empty: none
  std::size_t num_left = 0;
};

/// The physics could not go on, whatever was asked for: the bin is no good until it is filled anew.
class PhysicsFailure : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// A virtual bin that is filled, scanned and emptied as a cell at work is. The same parameters and the same calls give
/// the same bits. Not thread-safe.
class PickableCell
{
public:
  using Progress = bin_picking::simulation::BinPhysics::Progress;

  /// Reads the parts. \throws bin_picking::Error a part.yaml, mesh or parameter is wrong
  explicit PickableCell(const VirtualCellParameters& parameters);

  /// Empties the bin and fills it, each time with the seed after the one before; ids begin anew. An exception of
  /// `progress` ends it and reaches the caller. \throws bin_picking::ParameterError a part does not fit, too many parts
  void refill(const Progress& progress);

  /// All that lies in the bin falls anew, under new ids. \pre filled \throws PhysicsFailure
  void shake();

  /// One exposure with noise of its own.
  bin_picking::simulation::CellScan expose();

  /// Fails, or loses the part, as often as the parameters say. \throws PhysicsFailure
  PickOutcome take(int id);

  /// Makes a grip and judges it. Fails, or loses the part, as often as the parameters say.
  /// \throws bin_picking::ParameterError no gripper is mounted, a path that no robot can take (see GripJudge)
  /// \throws PhysicsFailure
  GripOutcome grip(const bin_picking::simulation::GripPath& path);

  /// The part whose middle is nearest to that of a part at the pose; none within the tolerance: nothing.
  /// \param part name; empty: any
  std::optional<int> partAt(const bin_picking::Pose& T_camera_object, const std::string& part, double tolerance) const;

  bool hasPart(const std::string& name) const;

  std::size_t numLeft() const { return cell_ ? cell_->bodies().size() : 0; }
  std::uint32_t fillingSeed() const { return next_seed_ - 1; }
  /// \pre filled
  const bin_picking::simulation::VirtualCell& cell() const { return *cell_; }

private:
  PickOutcome::Kind takeGripped(int id);

  VirtualCellParameters parameters_;
  std::vector<bin_picking::simulation::CellPart> parts_;
  std::vector<Eigen::Vector3d> centers_;  ///< of the parts' surfaces, which no symmetry moves, part frames
  std::optional<bin_picking::Gripper> gripper_;
  std::optional<bin_picking::simulation::VirtualCell> cell_;
  std::optional<bin_picking::simulation::GripJudge> judge_;
  std::uint32_t next_seed_;
  std::mt19937 exposure_seeds_;  ///< apart from the next, so that watching the bin does not change what happens to it
  bin_picking::simulation::Random luck_;
};
}  // namespace bin_picking_ros
