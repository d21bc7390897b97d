// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "resource_path.hpp"

#include <ros/package.h>

#include <cstdlib>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking_ros
{
namespace
{
bool startsWith(const std::string& text, const std::string& prefix)
{
  return text.compare(0, prefix.size(), prefix) == 0;
}
}  // namespace

std::string resolveResource(const std::string& resource)
{
  const std::string package_scheme = "package://";
  const std::string file_scheme = "file://";
  if (startsWith(resource, package_scheme))
  {
    const std::string rest = resource.substr(package_scheme.size());
    const std::string package = rest.substr(0, rest.find('/'));
    const std::string path = ros::package::getPath(package);
    if (path.empty())
      throw bin_picking::ParameterError("The package " + package + " of " + resource +
                                        " is not known; source the workspace that holds it.");
    return path + rest.substr(package.size());
  }
  const std::string path = startsWith(resource, file_scheme) ? resource.substr(file_scheme.size()) : resource;
  if (path.empty() || path.front() != '/')
    throw bin_picking::ParameterError("The path \"" + resource +
                                      "\" is relative; use an absolute path or package://PACKAGE/PATH.");
  return path;
}

std::string rosHome()
{
  if (const char* ros_home = std::getenv("ROS_HOME"))
    return ros_home;
  const char* home = std::getenv("HOME");
  return std::string(home ? home : "") + "/.ros";
}
}  // namespace bin_picking_ros
