// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "node_parameters.hpp"

#include <set>

#include "bin_picking_perception/common/error.hpp"
#include "parameter_tree.hpp"

namespace bin_picking_ros
{
namespace
{
using bin_picking::ParameterError;
using XmlRpc::XmlRpcValue;

/// Parameters that ROS tools keep in the same namespace.
const std::set<std::string> FOREIGN = {"tuning", "diagnostic_period"};

void checkTogether(const NodeParameters& parameters)
{
  if (parameters.parts.empty())
    throw ParameterError(
        "The parameter parts is missing or empty; it must name at least one directory with a part.yaml.");
  if (parameters.bin.empty() && !parameters.bin_frame.empty())
    throw ParameterError("The parameter bin_frame is " + parameters.bin_frame +
                         ", but bin is empty; the bin's size is read from the file that bin names.");
}
}  // namespace

void NodeParameters::visit(bin_picking::ParameterVisitor& v)
{
  v.field({"preset", "", "speed against completeness; the values below `detector` change it in detail"}, preset,
          std::vector<std::string>{"paper", "fast", "accurate"});
  v.field({"model_cache", "", "directory where trained models are kept; empty: bin_picking_models in the ROS home"},
          model_cache, std::vector<std::string>{});
  v.field({"bin", "", "YAML file with pose and size of the bin; empty: parts are searched everywhere"}, bin,
          std::vector<std::string>{});
  v.field({"bin_frame", "", "tf frame of the bin (middle of the inner floor, z up); replaces the pose in the file"},
          bin_frame, std::vector<std::string>{});
  v.field({"gripper", "", "YAML file of the gripper that is meant where a request names none"}, gripper,
          std::vector<std::string>{});
  v.field({"robot", "", "YAML file of the robot, to offer only what it reaches; empty: reach is not checked"}, robot,
          std::vector<std::string>{});
  v.field({"robot_base_frame", "", "tf frame base_link of the robot (ROS-I), whatever it is called; used with robot"},
          robot_base_frame, std::vector<std::string>{});
  v.field({"output_frame", "", "frame of all results; empty: the frame of the cloud"}, output_frame,
          std::vector<std::string>{});
  v.field({"tf_prefix", "", "put before the names of the published tf frames; keeps two detectors apart"}, tf_prefix,
          std::vector<std::string>{});
  v.field({"tf_timeout", "s", "how long a transform at the cloud's time is waited for", 0, 60}, tf_timeout);
  v.field({"max_age", "s", "oldest cloud that USE_LATEST takes when the request does not say", 0, 86400}, max_age);
  v.field({"cloud_timeout", "s", "how long WAIT_NEW waits for a cloud", 0, 3600}, cloud_timeout);
  v.field({"deadline", "s", "time for a whole request when it does not say; 0: none", 0, 3600}, deadline);
  v.field({"remembered_answers", "", "answers whose grasps ~report_pick still knows", 1, 1000}, remembered_answers);
  v.field({"process", "", "on_demand: clouds are processed when the service asks; continuous: all the time"}, process,
          {{"on_demand", ProcessMode::OnDemand}, {"continuous", ProcessMode::Continuous}});
  v.group("training", training);
  v.group("detector", detector);
  v.group("grasping", grasping);
  v.group("avoid", avoid);
}

// By value: older releases of xmlrpcpp read a value through functions that are not const.
// NOLINTNEXTLINE(performance-unnecessary-value-param)
NodeParameters parseNodeParameters(XmlRpcValue tree)
{
  NodeParameters parameters;
  const auto visit = bin_picking::visitor(parameters);
  XmlRpcValue rest;
  rest.begin();  // makes it a struct, also if nothing is left
  for (auto& [name, value] : tree)
  {
    if (name == "parts")
      parameters.parts = readTexts(value, name, "the directories of the parts");
    else if (name == "grippers")
      parameters.grippers = readTexts(value, name, "files of grippers");
    else if (name == "preset")
      bin_picking::setParameter(visit, name, scalarText(value, name));
    else if (FOREIGN.count(name) == 0)
      rest[name] = value;
  }
  parameters.detector = bin_picking::DetectorParameters::preset(parameters.preset);
  for (const auto& [path, text] : flatten(rest))
    bin_picking::setParameter(visit, path, text);
  checkTogether(parameters);
  return parameters;
}

NodeParameters readNodeParameters(const ros::NodeHandle& private_nh)
{
  return parseNodeParameters(readTree(private_nh));
}
}  // namespace bin_picking_ros
