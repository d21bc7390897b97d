// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "cloud_conversion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking_ros
{
namespace
{
using bin_picking::CloudError;
using bin_picking::CloudFault;
using sensor_msgs::PointCloud2;
using sensor_msgs::PointField;

[[noreturn]] void badLayout(const std::string& what)
{
  throw CloudError(CloudFault::BadLayout, "The point cloud cannot be read: " + what);
}

std::string fieldNames(const PointCloud2& message)
{
  std::string names;
  for (const PointField& field : message.fields)
    names += (names.empty() ? "" : ", ") + field.name;
  return names.empty() ? "none" : names;
}

const PointField& findField(const PointCloud2& message, const char* name)
{
  const auto field = std::find_if(message.fields.begin(), message.fields.end(),
                                  [name](const PointField& candidate) { return candidate.name == name; });
  if (field == message.fields.end())
    badLayout(std::string("it has no field ") + name + " (fields: " + fieldNames(message) + ").");
  return *field;
}

std::size_t scalarSize(const PointField& field)
{
  if (field.datatype == PointField::FLOAT32)
    return sizeof(float);
  if (field.datatype == PointField::FLOAT64)
    return sizeof(double);
  badLayout("field " + field.name + " has data type " + std::to_string(field.datatype) +
            "; x, y and z must be FLOAT32 (7) or FLOAT64 (8).");
}

/// Sums of 32-bit sizes are formed in 64 bits, so that absurd ones cannot wrap around.
void checkSizes(const PointCloud2& message)
{
  const std::uint64_t row_bytes = std::uint64_t{message.width} * message.point_step;
  if (message.row_step < row_bytes)
    badLayout("row_step is " + std::to_string(message.row_step) + ", but " + std::to_string(message.width) +
              " points of " + std::to_string(message.point_step) + " bytes need " + std::to_string(row_bytes) + ".");
  const std::uint64_t needed = std::uint64_t{message.row_step} * (message.height - 1) + row_bytes;
  if (message.data.size() < needed)
    badLayout("it is truncated: " + std::to_string(message.width) + " x " + std::to_string(message.height) +
              " points need " + std::to_string(needed) + " bytes, " + std::to_string(message.data.size()) +
              " are there.");
}

bool hostIsBigEndian()
{
  const std::uint16_t probe = 1;
  std::uint8_t first = 0;
  std::memcpy(&first, &probe, 1);
  return first == 0;
}

/// Where x, y and z lie within a point, checked once for the whole cloud.
class PointReader
{
public:
  explicit PointReader(const PointCloud2& message) : message_(message)
  {
    if (message.width == 0 || message.height == 0)
      throw CloudError(CloudFault::Empty, "The point cloud is empty: " + std::to_string(message.width) + " x " +
                                              std::to_string(message.height) + " points.");
    constexpr std::array<const char*, 3> NAMES = {"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i)
    {
      const PointField& field = findField(message, NAMES[i]);
      size_[i] = scalarSize(field);
      offset_[i] = field.offset;
      if (std::uint64_t{field.offset} + size_[i] > message.point_step)
        badLayout("field " + field.name + " at offset " + std::to_string(field.offset) +
                  " does not fit into a point of " + std::to_string(message.point_step) + " bytes.");
    }
    checkSizes(message);
    swap_ = (message.is_bigendian != 0) != hostIsBigEndian();
    plain_ = !swap_ && size_[0] == sizeof(float) && size_[1] == sizeof(float) && size_[2] == sizeof(float);
  }

  pcl::PointXYZ read(std::size_t row, std::size_t column) const
  {
    const std::uint8_t* point = message_.data.data() + row * message_.row_step + column * message_.point_step;
    pcl::PointXYZ result;
    for (std::size_t i = 0; i < 3; ++i)
      result.data[i] = plain_ ? readPlain(point + offset_[i]) : readAny(point + offset_[i], size_[i]);
    return result;
  }

private:
  static float readPlain(const std::uint8_t* bytes)
  {
    float value;
    std::memcpy(&value, bytes, sizeof(value));
    return value;
  }

  float readAny(const std::uint8_t* bytes, std::size_t size) const
  {
    std::array<std::uint8_t, sizeof(double)> buffer{};
    std::copy(bytes, bytes + size, buffer.begin());
    if (swap_)
      std::reverse(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(size));
    if (size == sizeof(float))
      return readPlain(buffer.data());
    double value;
    std::memcpy(&value, buffer.data(), sizeof(value));
    return static_cast<float>(value);
  }

  const PointCloud2& message_;
  std::array<std::size_t, 3> offset_{};
  std::array<std::size_t, 3> size_{};
  bool swap_ = false;
  bool plain_ = false;
};

bool isMeasured(const pcl::PointXYZ& p)
{
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) && (p.x != 0.0f || p.y != 0.0f || p.z != 0.0f);
}
}  // namespace

pcl::PointCloud<pcl::PointXYZ> toPclCloud(const PointCloud2& message)
{
  const PointReader reader(message);
  pcl::PointCloud<pcl::PointXYZ> cloud(message.width, message.height);
  cloud.is_dense = false;
  for (std::size_t row = 0; row < message.height; ++row)
    for (std::size_t column = 0; column < message.width; ++column)
      cloud.points[row * message.width + column] = reader.read(row, column);
  return cloud;
}

CloudSummary summarizeCloud(const PointCloud2& message, std::size_t stride)
{
  const PointReader reader(message);
  CloudSummary summary;
  std::vector<float> depths;
  for (std::size_t row = 0; row < message.height; row += stride)
    for (std::size_t column = 0; column < message.width; column += stride)
    {
      const pcl::PointXYZ point = reader.read(row, column);
      ++summary.sampled;
      if (isMeasured(point))
        depths.push_back(point.z);
    }
  summary.valid = depths.size();
  summary.median_depth = std::numeric_limits<double>::quiet_NaN();
  if (!depths.empty())
  {
    const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
    std::nth_element(depths.begin(), middle, depths.end());
    summary.median_depth = *middle;
  }
  return summary;
}
}  // namespace bin_picking_ros
