// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/grasping/grasp.hpp"
#include "bin_picking_perception/grasping/grasp_parameters.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "bin_picking_perception/robot/robot.hpp"

namespace bin_picking
{
struct PreparedPart;

/// From detections to grasps that a robot can take: each grasp of each part, expanded by symmetry and tolerance, is
/// held against what a person would check, in this order: the detection (matching rate, open turn, avoid list), the
/// gripper's kind and opening, the tilt, the collisions of held part and gripper on the whole way, the robot's reach.
/// What remains is ranked. Immutable; thread-safe.
///
/// The whole way goes from pre-grasp to grasp to retreat. What of it lies within the bin is continued: straight down
/// from over the rim to the pre-grasp, and straight up until the part is out.
///
/// What is written comes first: copies turned or tilted by a tolerance are tried for detections that have no other
/// grasp, in their order, as long as there are fewer than enough_grasps (and max_grasps), and up to a few for each.
///
/// The rejected are listed detection by detection: each grasp as written and each of its copies around an axis or by
/// symmetry (one for all where the reason does not depend on the copy, and of those too steep the least steep), and of
/// the turned and tilted copies one for each grasp as written and kind of rejection that is not listed yet.
class GraspPlanner
{
public:
  struct Setup
  {
    std::vector<PartDefinition> parts;  ///< by name; a detection of a part without definition has no grasps
    Gripper gripper;
    std::optional<Robot> robot;  ///< none: reach is not checked
    GraspParameters parameters;
    int num_threads = 0;  ///< 0: as many as the machine has
  };

  /// \throws ParameterError a parameter out of its range; a gripper without bodies
  explicit GraspPlanner(Setup setup);

  struct Scene
  {
    const DetectionResult& detection;
    const std::vector<std::shared_ptr<const TrainedModel>>& models;  ///< that Detection::model_index points into
    const Bin* bin = nullptr;           ///< nullptr: no wall check; tilt is measured against the view direction
    std::optional<Pose> T_base_camera;  ///< of the robot's DH base; needed where reach is checked
    bool without_cloud = false;         ///< collisions with the bin and the detected parts alone, knowingly
  };

  struct Request
  {
    bool accept_undetermined_turn = false;  ///< also parts whose turn about an axis is not known, at the stated pose
    bool check_collision = true;
    bool check_reach = true;
    /// Why a detection is to be left alone, one sentence; an empty text: it is not. No function: none is.
    std::function<std::string(std::size_t detection_index)> avoid;
    std::size_t max_grasps = 0;  ///< fewer than the parameter; 0: that many
  };

  /// \throws ParameterError reach is to be checked, but T_base_camera is missing; collisions are, but the detection has
  /// no surroundings; a pose that is not finite
  GraspSelection plan(const Scene& scene, const Request& request) const;

  const Setup& setup() const { return setup_; }

private:
  Setup setup_;
  std::optional<Kinematics> kinematics_;
  std::shared_ptr<const std::vector<PreparedPart>> prepared_;  ///< as setup_.parts
  Executor executor_;
};
}  // namespace bin_picking
