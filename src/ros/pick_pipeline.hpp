// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/grasping/avoid_list.hpp"
#include "bin_picking_perception/grasping/grasp_planner.hpp"
#include "gripper_set.hpp"
#include "return_code.hpp"

namespace bin_picking_ros
{
/// For each of these middles of parts (in the cloud's frame, metres), the place that it is avoided for, if any.
using AvoidQuery = std::function<std::vector<std::optional<bin_picking::AvoidedPlace>>(
    const std::vector<Eigen::Vector3d>& centers_camera)>;

/// What a caller wants to know about one cloud.
struct PickRequest
{
  std::vector<std::string> parts;         ///< names; empty: all
  std::optional<bin_picking::Bin> bin;    ///< in the cloud's frame
  double deadline = 0;                    ///< seconds from now, for the detection; 0: none
  std::size_t max_grasps = 0;             ///< at most as many as the parameters allow; 0: that many
  bool accept_undetermined_turn = false;  ///< also grasps of parts whose turn about an axis is not known
  bool keep_segmentation = false;
  std::string gripper;  ///< name; empty: the one that is meant where nobody says which
  bool skip_collision = false;
  bool skip_reach = false;
  std::optional<bin_picking::Pose> T_base_camera;  ///< in `base` of the robot; nothing: reach is not checked
  AvoidQuery avoided;                              ///< nothing: no part is avoided
};

/// Everything that follows from one cloud. Poses are in the cloud's frame.
struct PickResult
{
  ReturnCode code;
  std_msgs::Header cloud_header;
  std::optional<bin_picking::Bin> bin;
  std::string gripper;  ///< name of the one that the grasps are meant for
  bin_picking::DetectionResult detection;
  std::vector<Eigen::Vector3d> centers;  ///< middles of the accepted detections
  bin_picking::GraspSelection selection;
  std::vector<bin_picking::AvoidedPlace> avoided;  ///< all places that are avoided now
};

/// From a cloud to ranked grasps: conversion, detection, grasp planning. Immutable and thread-safe; other parameters
/// make another pipeline, the trained models are shared.
class PickPipeline
{
public:
  struct Setup
  {
    std::vector<std::shared_ptr<const bin_picking::TrainedModel>> models;
    std::vector<bin_picking::PartDefinition> parts;
    GripperSet grippers;
    bin_picking::DetectorParameters detector;
    bin_picking::GraspParameters grasping;
    std::optional<bin_picking::Robot> robot;  ///< nothing: reach is not checked
  };

  /// \throws bin_picking::ParameterError no models, or a parameter is out of range
  explicit PickPipeline(Setup setup);

  /// "Nothing found" is a result with its code. \throws bin_picking::CloudError,
  /// RequestError(PART_UNKNOWN, GRIPPER_UNKNOWN)
  PickResult run(const sensor_msgs::PointCloud2& cloud, const PickRequest& request) const;

  /// \throws RequestError(PART_UNKNOWN) if a name is not among the loaded parts, with the nearest one
  void requireParts(const std::vector<std::string>& names) const;

  const Setup& setup() const { return setup_; }

private:
  bin_picking::GraspSelection plan(const PickResult& result, const PickRequest& request) const;

  Setup setup_;
  bin_picking::Detector detector_;
  std::map<std::string, bin_picking::GraspPlanner> planners_;  ///< by the gripper's name
};
}  // namespace bin_picking_ros
