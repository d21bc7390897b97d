// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "virtual_cell_parameters.hpp"

#include <limits>

#include "bin_picking_perception/common/error.hpp"
#include "parameter_tree.hpp"

namespace bin_picking_ros
{
namespace
{
using bin_picking::ParameterError;
using XmlRpc::XmlRpcValue;

struct Count
{
  int value = 0;

  void visit(bin_picking::ParameterVisitor& v)
  {
    v.field({"counts", "", "parts of one kind; one number for all kinds, or a list with one per kind", 0, 60}, value);
  }
};

int parseCount(const std::string& text)
{
  Count count;
  bin_picking::setParameter(bin_picking::visitor(count), "counts", text);
  return count.value;
}

/// A number, "12, 5", or a list.
std::vector<int> readCounts(XmlRpcValue& value)
{
  std::vector<int> counts;
  if (value.getType() == XmlRpcValue::TypeArray)
    for (int i = 0; i < value.size(); ++i)
      counts.push_back(parseCount(scalarText(value[i], "counts[" + std::to_string(i) + "]")));
  else
    for (const std::string& text : splitAtCommas(scalarText(value, "counts")))
      counts.push_back(parseCount(text));
  return counts;
}

void completeLists(VirtualCellParameters& parameters)
{
  const std::size_t num_parts = parameters.parts.size();
  if (num_parts == 0)
    throw ParameterError(
        "The parameter parts is missing or empty; it must name at least one directory with a part.yaml.");
  if (parameters.counts.size() == 1)
    parameters.counts.assign(num_parts, parameters.counts.front());
  if (parameters.counts.size() != num_parts)
    throw ParameterError("The parameter counts has " + std::to_string(parameters.counts.size()) + " numbers for " +
                         std::to_string(num_parts) + " parts; give one number for all or one per part.");
}
}  // namespace

void VirtualCellParameters::visit(bin_picking::ParameterVisitor& v)
{
  const double max_int = std::numeric_limits<int>::max();
  v.field({"seed", "", "another number gives another bin, other noise and other failures", 0, max_int}, seed);
  v.field({"frame_id", "", "frame of the clouds, the camera's optical frame"}, frame_id, std::vector<std::string>{});
  v.field({"bin_frame", "", "static tf frame of the bin (middle of the inner floor, z up); empty: none is published"},
          bin_frame, std::vector<std::string>{});
  v.field({"rate", "Hz", "clouds per second while somebody subscribes; 0: only when ~trigger is called", 0, 100}, rate);
  v.field({"failure_probability", "", "share of the calls of ~take_part and ~grip that miss the part", 0, 1},
          failure_probability);
  v.field({"drop_probability", "", "share of the gripped parts that fall back into the bin", 0, 1}, drop_probability);
  v.field({"tolerance", "m", "how far from the pose given to ~take_part the middle of a part may lie", 0.0001, 1},
          tolerance);
  v.field({"tf_timeout", "s", "how long ~take_part and ~grip wait for the transform of a pose", 0, 60}, tf_timeout);
  v.field({"num_threads", "", "threads of the sensor; 0: all processors", 0, 1024}, num_threads);
  v.field({"gripper", "", "file that describes the gripper mounted on the virtual robot; empty: none, and no ~grip"},
          gripper, std::vector<std::string>{});
  v.group("grip", grip);
  cell.visit(v);
}

// By value: older releases of xmlrpcpp read a value through functions that are not const.
// NOLINTNEXTLINE(performance-unnecessary-value-param)
VirtualCellParameters parseVirtualCellParameters(XmlRpcValue tree)
{
  VirtualCellParameters parameters;
  parameters.counts = {DEFAULT_PART_COUNT};
  const auto visit = bin_picking::visitor(parameters);
  XmlRpcValue rest;
  rest.begin();  // makes it a struct, also if nothing is left
  for (auto& [name, value] : tree)
  {
    if (name == "parts")
      parameters.parts = readTexts(value, name, "the directories of the parts");
    else if (name == "counts")
      parameters.counts = readCounts(value);
    else
      rest[name] = value;
  }
  const auto leaves = flatten(rest);
  for (const bool is_first_round : {true, false})  // the type of the sensor brings defaults, which the others replace
    for (const auto& [path, text] : leaves)
      if ((path == "sensor/type") == is_first_round)
        bin_picking::setParameter(visit, path, text);
  completeLists(parameters);
  return parameters;
}

VirtualCellParameters readVirtualCellParameters(const ros::NodeHandle& private_nh)
{
  return parseVirtualCellParameters(readTree(private_nh));
}
}  // namespace bin_picking_ros
