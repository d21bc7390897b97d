// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/grasping/grasp_selection.hpp"
#include "return_code.hpp"

namespace bin_picking_ros
{
/// What a caller wants to know about one cloud.
struct PickRequest
{
  std::vector<std::string> parts;         ///< names; empty: all
  std::optional<bin_picking::Bin> bin;    ///< in the cloud's frame
  double deadline = 0;                    ///< seconds from now; 0: none
  std::size_t max_grasps = 0;             ///< at most as many as the parameters allow; 0: that many
  bool accept_undetermined_turn = false;  ///< also grasps of parts whose turn about an axis is not known
  bool keep_segmentation = false;
};

/// Everything that follows from one cloud. Poses are in the cloud's frame.
struct PickResult
{
  ReturnCode code;
  std_msgs::Header cloud_header;
  std::optional<bin_picking::Bin> bin;
  bin_picking::DetectionResult detection;
  bin_picking::GraspSelection selection;
};

/// From a cloud to ranked grasps: conversion, detection, grasp selection. Immutable and thread-safe; other parameters
/// make another pipeline, the trained models are shared.
class PickPipeline
{
public:
  struct Setup
  {
    std::vector<std::shared_ptr<const bin_picking::TrainedModel>> models;
    std::vector<bin_picking::PartDefinition> parts;
    bin_picking::Gripper gripper;
    bin_picking::DetectorParameters detector;
    bin_picking::GraspParameters grasping;
  };

  /// \throws bin_picking::ParameterError no models, or a parameter is out of range
  explicit PickPipeline(Setup setup);

  /// "Nothing found" is a result with its code. \throws bin_picking::CloudError, RequestError(PART_UNKNOWN)
  PickResult run(const sensor_msgs::PointCloud2& cloud, const PickRequest& request) const;

  /// \throws RequestError(PART_UNKNOWN) if a name is not among the loaded parts, with the nearest one
  void requireParts(const std::vector<std::string>& names) const;

  const Setup& setup() const { return setup_; }

private:
  Setup setup_;
  bin_picking::Detector detector_;
};
}  // namespace bin_picking_ros
