// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "tuning.hpp"

#include <ros/console.h>

#include <sstream>

#include "return_code.hpp"

namespace bin_picking_ros
{
const std::vector<std::pair<std::string, std::string>>& tunableParameters()
{
  static const std::vector<std::pair<std::string, std::string>> names = {
      {"min_matching_rate", "detector/verification/min_matching_rate"},
      {"min_visible_fraction", "detector/verification/min_visible_fraction"},
      {"min_inlier_share", "detector/verification/min_inlier_share"},
      {"max_violation_share", "detector/verification/max_violation_share"},
      {"reference_share", "detector/voting/reference_share"},
      {"edge_depth", "detector/segmentation/edge_depth"},
      {"grasp_min_matching_rate", "grasping/min_matching_rate"},
      {"grasp_max_tilt", "grasping/max_tilt"},
      {"grasp_bin_clearance", "grasping/obstacles/bin_clearance"},
  };
  return names;
}

BinPickingConfig toConfig(NodeParameters parameters)
{
  BinPickingConfig config = BinPickingConfig::__getDefault__();
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  const auto entries = bin_picking::listParameters(bin_picking::visitor(parameters));
  for (dynamic_reconfigure::DoubleParameter& value : message.doubles)
    for (const auto& [name, path] : tunableParameters())
      for (const bin_picking::ParameterEntry& entry : entries)
        if (value.name == name && entry.path == path)
          value.value = std::stod(entry.value);
  config.__fromMessage__(message);
  return config;
}

NodeParameters withConfig(NodeParameters parameters, BinPickingConfig config)
{
  dynamic_reconfigure::Config message;
  config.__toMessage__(message);
  for (const dynamic_reconfigure::DoubleParameter& value : message.doubles)
    for (const auto& [name, path] : tunableParameters())
      if (value.name == name)
      {
        std::ostringstream text;
        text.precision(17);
        text << value.value;
        bin_picking::setParameter(bin_picking::visitor(parameters), path, text.str());
      }
  return parameters;
}

Tuning::Tuning(const ros::NodeHandle& private_nh, const NodeParameters& parameters, OnChange on_change)
    : parameters_(parameters), on_change_(std::move(on_change))
{
  const ros::NodeHandle tuning_nh(private_nh, "tuning");
  toConfig(parameters).__toServer__(tuning_nh);
  server_ = std::make_unique<dynamic_reconfigure::Server<BinPickingConfig>>(tuning_nh);
  server_->setCallback([this](BinPickingConfig& config, std::uint32_t) { reconfigure(config); });
}

void Tuning::reconfigure(const BinPickingConfig& config)
{
  try
  {
    parameters_ = withConfig(parameters_, config);
    on_change_(parameters_);
  }
  catch (...)
  {
    ROS_ERROR_STREAM("The new values are not used: " << translateException(std::current_exception()).message);
  }
}
}  // namespace bin_picking_ros
