// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <pcl/conversions.h>
#include <pcl/io/pcd_io.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <fstream>
#include <set>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/scene/cloud_input.hpp"

namespace bin_picking
{
namespace
{
constexpr int MAX_HEADER_LINES = 100;

/// PCL's reader crashes on files that are not PCD at all; the words of a header are looked for first.
void requireHeader(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  // A folder can be opened too; only reading tells.
  if (!file || file.peek() == std::ifstream::traits_type::eof())
    throw FileError("The point cloud " + path + " is missing, empty or cannot be read; give the path of a PCD file.");
  std::set<std::string> missing = {"FIELDS", "SIZE", "TYPE", "WIDTH", "HEIGHT", "POINTS", "DATA"};
  std::string line;
  for (int k = 0; k < MAX_HEADER_LINES && missing.count("DATA") > 0 && std::getline(file, line); ++k)
  {
    std::istringstream words(line);
    std::string key;
    std::string value;
    words >> key >> value;
    if (!value.empty())
      missing.erase(key);
    if (key == "POINTS" && value == "0")
      throw CloudError(CloudFault::Empty, "The point cloud " + path + " has no points; at least one must be measured.");
  }
  if (!missing.empty())
    throw FileError("The point cloud " + path + " has no line '" + *missing.begin() +
                    "' in its header: it is not a PCD file or is damaged; save it again.");
}

void requireFields(const pcl::PCLPointCloud2& blob, const std::string& path)
{
  std::set<std::string> missing = {"x", "y", "z"};
  for (const auto& field : blob.fields)
    if (field.datatype == pcl::PCLPointField::FLOAT32 && field.count == 1)
      missing.erase(field.name);
  if (!missing.empty())
    throw FileError("The point cloud " + path + " has no field '" + *missing.begin() +
                    "' of 32-bit floats; the fields x, y and z are needed. Save it again as pcl::PointXYZ.");
}
}  // namespace

pcl::PointCloud<pcl::PointXYZ> loadCloud(const std::string& path)
{
  requireHeader(path);
  pcl::PCLPointCloud2 blob;
  int status = -1;
  try
  {
    status = pcl::PCDReader().read(path, blob);
  }
  catch (const std::exception& e)
  {
    throw FileError("The point cloud " + path + " cannot be read (" + e.what() + "); give an intact PCD file.");
  }
  if (status < 0)
    throw FileError("The point cloud " + path + " is not a PCD file or is damaged; save it again.");
  requireFields(blob, path);
  pcl::PointCloud<pcl::PointXYZ> cloud;
  pcl::fromPCLPointCloud2(blob, cloud);
  return cloud;
}

DepthGrid loadGrid(const std::string& path, const InputParameters& parameters)
{
  return makeGrid(loadCloud(path), parameters);
}

void saveGrid(const DepthGrid& grid, const std::string& path)
{
  pcl::PointCloud<pcl::PointXYZ> cloud(static_cast<std::uint32_t>(grid.width), static_cast<std::uint32_t>(grid.height));
  for (std::size_t i = 0; i < grid.size(); ++i)
    cloud.points[i] = pcl::PointXYZ(grid.x[i], grid.y[i], grid.z[i]);
  cloud.is_dense = false;
  int status = -1;
  std::string reason;
  try
  {
    status = pcl::PCDWriter().writeBinary(path, cloud);
  }
  catch (const std::exception& e)
  {
    reason = std::string(" (") + e.what() + ")";
  }
  if (status < 0)
    throw FileError("The point cloud cannot be written to " + path + reason +
                    "; check that the folder exists and has room.");
}
}  // namespace bin_picking
