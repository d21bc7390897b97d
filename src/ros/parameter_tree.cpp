// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "parameter_tree.hpp"

#include <ros/param.h>

#include <limits>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking_ros
{
namespace
{
using bin_picking::ParameterError;
using XmlRpc::XmlRpcValue;

std::string numberText(double value)
{
  std::ostringstream text;
  text.precision(std::numeric_limits<double>::max_digits10);
  text << value;
  return text.str();
}
}  // namespace

XmlRpc::XmlRpcValue readTree(const ros::NodeHandle& private_nh)
{
  XmlRpc::XmlRpcValue tree;
  if (!ros::param::get(private_nh.getNamespace(), tree) || tree.getType() != XmlRpc::XmlRpcValue::TypeStruct)
    throw bin_picking::ParameterError("There are no parameters below " + private_nh.getNamespace() +
                                      "; at least parts must be set.");
  return tree;
}

std::string scalarText(XmlRpcValue& value, const std::string& path)
{
  switch (value.getType())
  {
    case XmlRpcValue::TypeBoolean:
      return static_cast<bool&>(value) ? "true" : "false";
    case XmlRpcValue::TypeInt:
      return std::to_string(static_cast<int&>(value));
    case XmlRpcValue::TypeDouble:
      return numberText(static_cast<double&>(value));
    case XmlRpcValue::TypeString:
      return static_cast<std::string&>(value);
    default:
      throw ParameterError("The parameter " + path +
                           " is a list or binary data; a number, true, false or a text is wanted.");
  }
}

// By value: older releases of xmlrpcpp read a value through functions that are not const.
// NOLINTNEXTLINE(performance-unnecessary-value-param)
std::vector<std::pair<std::string, std::string>> flatten(XmlRpcValue tree, const std::string& prefix)
{
  std::vector<std::pair<std::string, std::string>> leaves;
  for (auto& [name, value] : tree)
  {
    const std::string path = prefix + name;
    if (value.getType() != XmlRpcValue::TypeStruct)
    {
      leaves.emplace_back(path, scalarText(value, path));
      continue;
    }
    const auto nested = flatten(value, path + "/");
    leaves.insert(leaves.end(), nested.begin(), nested.end());
  }
  return leaves;
}

std::vector<std::string> splitAtCommas(const std::string& text)
{
  const char* const white = " \t\n";
  std::vector<std::string> entries;
  std::istringstream stream(text);
  for (std::string entry; std::getline(stream, entry, ',');)
  {
    const std::size_t first = entry.find_first_not_of(white);
    if (first != std::string::npos)
      entries.push_back(entry.substr(first, entry.find_last_not_of(white) + 1 - first));
  }
  return entries;
}

std::vector<std::string> readTexts(XmlRpcValue& value, const std::string& path, const std::string& wanted)
{
  if (value.getType() == XmlRpcValue::TypeString)
    return splitAtCommas(static_cast<std::string&>(value));
  if (value.getType() != XmlRpcValue::TypeArray)
    throw ParameterError("The parameter " + path + " is neither a text nor a list; it must name " + wanted + ".");
  std::vector<std::string> texts;
  for (int i = 0; i < value.size(); ++i)
  {
    if (value[i].getType() != XmlRpcValue::TypeString)
    {
      std::ostringstream text;
      text << "Entry " << i << " of the parameter " << path << " is not a text; it must name " << wanted << ".";
      throw ParameterError(text.str());
    }
    texts.push_back(static_cast<std::string&>(value[i]));
  }
  return texts;
}
}  // namespace bin_picking_ros
