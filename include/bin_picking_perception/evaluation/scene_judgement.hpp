// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/evaluation/evaluation_dataset.hpp"
#include "bin_picking_perception/evaluation/part_shape.hpp"
#include "bin_picking_perception/evaluation/pose_error.hpp"

namespace bin_picking
{
struct EvaluationParameters
{
  double max_error_share = 0.1;
  std::string visible_levels = "0.5 0.85";

  void visit(ParameterVisitor& v);

  /// visible_levels as numbers, ascending. \throws ParameterError none, not numbers, or outside (0, 1]
  std::vector<double> levels() const;
};

/// A pose that some program returned, ours or another.
struct PoseEstimate
{
  std::string part;
  Pose T_camera_object = Pose::Identity();
  double score = 0;                                                  ///< larger is better
  std::optional<UndeterminedTurn> undetermined_turn = std::nullopt;  ///< what it says that it leaves open
};

enum class Verdict
{
  Right,      ///< hits an instance that is visible enough to be asked for
  Hidden,     ///< hits an instance that is less visible than the lowest level: true, but nobody asked for it
  Duplicate,  ///< hits an instance that a better one has hit already
  Wrong       ///< hits none
};

/// "right", "hidden", "duplicate", "wrong".
const char* toString(Verdict verdict);

struct JudgedEstimate
{
  PoseEstimate estimate;
  Verdict verdict = Verdict::Wrong;
  /// The instance that it hits; if it hits none, the one of the same part whose middle is within half a diameter.
  std::optional<std::size_t> instance;
  PoseError error;                                                  ///< to that instance, at the part's middle
  double max_distance = std::numeric_limits<double>::quiet_NaN();   ///< MSSD to that instance, metres
  double mean_distance = std::numeric_limits<double>::quiet_NaN();  ///< ADD-S to that instance, metres

  bool isHit() const { return verdict == Verdict::Right || verdict == Verdict::Hidden; }
};

/// A pose that our detector tested in full, accepted or rejected.
struct TestedPose
{
  std::string part;
  double score = 0;  ///< confidence()
  PoseQuality quality;
  bool accepted = false;
  /// It hits some instance of its part, also one that a better pose has hit: the score speaks of the pose, not of the
  /// selection.
  bool right = false;
};

/// One timed run of the detector.
struct RunTime
{
  double total = 0;  ///< seconds
  std::vector<StageTime> stages;
  std::vector<StageCount> counts;
};

struct JudgedScene
{
  EvaluationScene scene;
  std::vector<JudgedEstimate> estimates;             ///< best first
  std::vector<std::optional<std::size_t>> found_by;  ///< per instance: index into estimates
  std::vector<bool> found_by_mean_distance;          ///< per instance: the same with ADD-S as the error
  std::vector<TestedPose> tested;                    ///< for the caller to fill (judgeTested)
  std::vector<RunTime> runs;                         ///< for the caller to fill
};

/// Best first, each estimate takes the free instance to which its error is smallest and below its limit.
/// \param errors row: estimate, column: instance. \return per estimate its instance
std::vector<std::optional<std::size_t>> assignGreedily(const Eigen::MatrixXd& errors,
                                                       const std::vector<double>& limits);

/// Holds estimates against the truth. An estimate hits an instance of its part if their MSSD is below max_error_share
/// of the part's diameter; assigned by assignGreedily. One that leaves a turn open claims no more than that: its errors
/// are those of the turn that fits best. \throws ParameterError a pose that is no rigid motion (a mirror
/// image, scaled, not finite), a score that is not a
///   number, a part that the scene does not search for, an instance without visible fraction
JudgedScene judgeScene(const EvaluationScene& scene, const std::vector<PoseEstimate>& estimates,
                       const PartShapes& shapes, const EvaluationParameters& parameters);

/// The poses of a result that have a quality, held against the truth as judgeScene does. Of the rejected ones a result
/// holds the best DetectorParameters::max_rejected.
std::vector<TestedPose> judgeTested(const EvaluationScene& scene, const DetectionResult& result,
                                    const PartShapes& shapes, const EvaluationParameters& parameters);

/// "right", "right up to its turn", "right, but hidden", "duplicate of #2", "off by 3.1 mm, 12.0 deg", "no part there".
std::string verdictText(const JudgedScene& scene, std::size_t estimate);
}  // namespace bin_picking
