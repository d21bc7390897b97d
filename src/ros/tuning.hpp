// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <bin_picking_perception/BinPickingConfig.h>
#include <dynamic_reconfigure/server.h>
#include <ros/node_handle.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "node_parameters.hpp"

namespace bin_picking_ros
{
using bin_picking_perception::BinPickingConfig;

/// The thresholds that one moves while looking at rviz: name in dynamic_reconfigure and path among the node's
/// parameters.
const std::vector<std::pair<std::string, std::string>>& tunableParameters();

/// The values of `parameters` as a dynamic_reconfigure configuration, and back.
BinPickingConfig toConfig(NodeParameters parameters);
/// \throws bin_picking::ParameterError out of the core's range
NodeParameters withConfig(NodeParameters parameters, BinPickingConfig config);

/// The dynamic_reconfigure server below ~tuning. It starts from the node's parameters, not from what an earlier run
/// left on the parameter server.
class Tuning
{
public:
  using OnChange = std::function<void(const NodeParameters&)>;

  Tuning(const ros::NodeHandle& private_nh, const NodeParameters& parameters, OnChange on_change);

private:
  void reconfigure(const BinPickingConfig& config);

  NodeParameters parameters_;
  OnChange on_change_;
  std::unique_ptr<dynamic_reconfigure::Server<BinPickingConfig>> server_;
};
}  // namespace bin_picking_ros
