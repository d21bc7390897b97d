// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <XmlRpcValue.h>
#include <ros/node_handle.h>

#include <string>
#include <vector>

#include "grip_trial.hpp"
#include "virtual_cell.hpp"

namespace bin_picking_ros
{
/// The private parameters of the virtual cell. Paths are absolute or package:// URLs.
struct VirtualCellParameters
{
  std::vector<std::string> parts;  ///< directories with a part.yaml each
  std::vector<int> counts;         ///< one per part
  int seed = 1;
  std::string frame_id = "camera";
  std::string bin_frame = "bin";
  double rate = 0;
  double failure_probability = 0;
  double drop_probability = 0;
  double tolerance = 0.02;
  double tf_timeout = 0.5;
  int num_threads = 0;
  std::string gripper;
  bin_picking::simulation::GripTrialParameters grip;
  bin_picking::simulation::CellParameters cell;

  /// All but `parts` and `counts`, which are lists.
  void visit(bin_picking::ParameterVisitor& v);
};

/// Parts of each kind where `counts` does not say.
constexpr int DEFAULT_PART_COUNT = 25;

/// From the tree of a private namespace. \throws bin_picking::ParameterError unknown name (with the nearest one), wrong
/// type, out of range, no parts, neither one count nor one per part
VirtualCellParameters parseVirtualCellParameters(XmlRpc::XmlRpcValue tree);

/// Reads everything below the private namespace. \throws as parseVirtualCellParameters
VirtualCellParameters readVirtualCellParameters(const ros::NodeHandle& private_nh);
}  // namespace bin_picking_ros
