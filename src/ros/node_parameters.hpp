// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <XmlRpcValue.h>
#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "bin_picking_perception/detector_parameters.hpp"
#include "bin_picking_perception/grasping/avoid_list.hpp"
#include "bin_picking_perception/grasping/grasp_parameters.hpp"
#include "bin_picking_perception/model/training_parameters.hpp"

namespace bin_picking_ros
{
enum class ProcessMode
{
  OnDemand,   ///< a cloud is processed when the service asks for it
  Continuous  ///< besides, every cloud is processed as soon as the one before is done
};

/// The private parameters of the detector. Paths are absolute or package:// URLs.
struct NodeParameters
{
  std::vector<std::string> parts;  ///< directories with a part.yaml each
  std::string preset = "fast";
  std::string model_cache;
  std::string bin;
  std::string bin_frame;
  std::string gripper = "package://bin_picking_perception/config/grippers/ag95.yaml";
  std::vector<std::string> grippers;  ///< further ones, which a request may name
  std::string robot;
  std::string robot_base_frame = "base_link";
  std::string output_frame;
  std::string tf_prefix;
  double tf_timeout = 0.5;
  double max_age = 5.0;
  double cloud_timeout = 5.0;
  double deadline = 10.0;
  int remembered_answers = 20;
  ProcessMode process = ProcessMode::OnDemand;
  bin_picking::TrainingParameters training;
  bin_picking::DetectorParameters detector = bin_picking::DetectorParameters::preset("fast");
  bin_picking::GraspParameters grasping;
  bin_picking::AvoidParameters avoid;

  /// All but the lists `parts` and `grippers`.
  void visit(bin_picking::ParameterVisitor& v);
};

/// From the tree of a private namespace. The preset is applied first, whatever the order. Branches that belong to ROS
/// tools (tuning, diagnostic_period) are passed over. \throws bin_picking::ParameterError unknown name (with the
/// nearest one), wrong type, out of range, no parts,
///   bin_frame without bin
NodeParameters parseNodeParameters(XmlRpc::XmlRpcValue tree);

/// Reads everything below the private namespace. \throws as parseNodeParameters
NodeParameters readNodeParameters(const ros::NodeHandle& private_nh);
}  // namespace bin_picking_ros
