// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "bin_picking_perception/scene/depth_grid.hpp"

namespace test_clouds
{
/// How the bytes of a cloud are arranged.
struct Layout
{
  std::vector<std::string> order = {"x", "y", "z"};  ///< fields as they follow each other
  bool float64 = false;
  bool big_endian = false;
  std::uint32_t lead = 0;  ///< unused bytes before the first field of a point
  std::uint32_t point_padding = 0;
  std::uint32_t row_padding = 0;
};

inline void putScalar(std::uint8_t* bytes, double value, const Layout& layout)
{
  const float single = static_cast<float>(value);
  const std::size_t size = layout.float64 ? sizeof(double) : sizeof(float);
  if (layout.float64)
    std::memcpy(bytes, &value, size);
  else
    std::memcpy(bytes, &single, size);
  if (layout.big_endian)  // the tests run on little-endian machines
    std::reverse(bytes, bytes + size);
}

/// The grid as a message; a missing field is one that `order` does not name.
inline sensor_msgs::PointCloud2 makeMessage(const bin_picking::DepthGrid& grid, const Layout& layout = Layout())
{
  const std::uint32_t size = layout.float64 ? 8 : 4;
  sensor_msgs::PointCloud2 message;
  message.header.frame_id = "camera";
  message.width = static_cast<std::uint32_t>(grid.width);
  message.height = static_cast<std::uint32_t>(grid.height);
  message.is_bigendian = static_cast<std::uint8_t>(layout.big_endian);
  message.is_dense = 1;  // a lie, as drivers tell it
  message.point_step = layout.lead + size * static_cast<std::uint32_t>(layout.order.size()) + layout.point_padding;
  message.row_step = message.point_step * message.width + layout.row_padding;
  message.data.assign(std::size_t{message.row_step} * message.height, 0xa5);
  for (std::size_t k = 0; k < layout.order.size(); ++k)
  {
    sensor_msgs::PointField field;
    field.name = layout.order[k];
    field.offset = layout.lead + size * static_cast<std::uint32_t>(k);
    field.datatype = layout.float64 ? sensor_msgs::PointField::FLOAT64 : sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    message.fields.push_back(field);
    const std::vector<float>& plane = field.name == "x" ? grid.x : (field.name == "y" ? grid.y : grid.z);
    for (std::uint32_t v = 0; v < message.height; ++v)
      for (std::uint32_t u = 0; u < message.width; ++u)
        putScalar(&message.data[std::size_t{v} * message.row_step + std::size_t{u} * message.point_step + field.offset],
                  plane[std::size_t{v} * message.width + u], layout);
  }
  return message;
}

/// Every coordinate, measured or not, replaced.
template <typename Function>
bin_picking::DepthGrid mapped(bin_picking::DepthGrid grid, Function function)
{
  for (auto* plane : {&grid.x, &grid.y, &grid.z})
    std::transform(plane->begin(), plane->end(), plane->begin(), function);
  return grid;
}
}  // namespace test_clouds
