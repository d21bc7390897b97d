// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "grip_trial.hpp"
#include "plan_grasps.hpp"
#include "virtual_cell.hpp"

namespace bin_picking::picking
{
/// One attempt, and what was known about it.
struct Attempt
{
  std::uint32_t seed = 0;  ///< of the bin
  int cloud = 0;           ///< number of the exposure
  std::string part;
  std::string grasp;
  double tilt = 0;
  double clearance = 0;      ///< as the answer states it
  double matching_rate = 0;  ///< of the detection
  double score = 0;
  double center_error = 0;    ///< of the detection against the nearest true part, metres
  double rotation_error = 0;  ///< rad, symmetry taken away
  simulation::GripVerdict verdict;
  bool called_free = false;  ///< a collision that the answer had vouched against
  /// Something was taken, but no part of the kind lies where the detection says: luck, and no success.
  bool another_part = false;

  bool succeeded() const { return verdict.outcome == simulation::GripVerdict::Outcome::Taken && !another_part; }
};

/// One bin, from full to the end.
struct Emptying
{
  std::uint32_t seed = 0;
  int filled = 0;
  int shakes = 0;  ///< where nothing was allowed any more
  std::vector<Attempt> attempts;
  std::map<std::string, int> left;  ///< why the parts that are left were not taken, or why it ended
  std::vector<double> detection_seconds;
  std::vector<double> planning_seconds;
  std::vector<double> judging_seconds;
};

struct EmptyingSettings
{
  int max_fruitless = 12;  ///< clouds in a row without an allowed grasp, after which the bin is given up
  bool shake = true;       ///< the bin is shaken where nothing is allowed
  int max_failures = 10;   ///< attempts in a row that fail, after which the bin is given up
  int max_picks = 0;       ///< attempts in one bin; 0: no limit
  bool truth = false;      ///< detections are replaced by the true poses
  simulation::GripTrialParameters grip;
};

/// Everything but the bin.
struct Workplace
{
  const Detector& detector;
  const GraspPlanner& planner;
  Pose T_base_camera;  ///< of the robot's base
  EmptyingSettings settings;
};

/// Scans, detects, plans, grips until the bin is empty or nothing is allowed.
Emptying emptyBin(simulation::VirtualCell& cell, const std::vector<int>& counts, std::uint32_t seed,
                  const Workplace& workplace);

/// The index of the true part that lies where a detection says, within 25 mm; the same kind only. Nothing: none.
std::optional<std::size_t> trueInstance(const Detection& detection, const simulation::CellScan& scan,
                                        const simulation::VirtualCell& cell, const Detector& detector);

/// Why the parts of this scan that are still in the bin were not taken: "not_detected"; "allowed", where a grasp is
/// still offered; else the cause that ruled out most of their grasps.
std::map<std::string, int> leftovers(const simulation::CellScan& scan, const simulation::VirtualCell& cell,
                                     const Detector& detector, const DetectionResult& result, const GraspPlan& plan);
}  // namespace bin_picking::picking
