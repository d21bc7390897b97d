// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "segmentation_image.hpp"

#include <sensor_msgs/image_encodings.h>

#include <Eigen/Core>
#include <cmath>

namespace bin_picking_ros
{
namespace
{
/// Neighbouring labels differ much: the hue advances by the golden ratio.
Eigen::Vector3f labelColor(std::int32_t label)
{
  const double hue = std::fmod(0.618034 * label, 1.0) * 6.0;
  const auto channel = [hue](double shift) {
    const double distance = std::abs(std::fmod(hue + shift, 6.0) - 3.0);
    return static_cast<float>(std::min(1.0, std::max(0.0, distance - 1.0)));
  };
  return {channel(0.0), channel(4.0), channel(2.0)};
}
}  // namespace

sensor_msgs::Image toImage(const bin_picking::SegmentationView& view, const std_msgs::Header& header)
{
  sensor_msgs::Image image;
  image.header = header;
  image.width = static_cast<std::uint32_t>(view.width);
  image.height = static_cast<std::uint32_t>(view.height);
  image.encoding = sensor_msgs::image_encodings::RGB8;
  image.step = 3 * image.width;
  image.data.resize(std::size_t{image.step} * image.height);
  for (std::size_t i = 0; i < view.gray.size(); ++i)
  {
    const float gray = view.gray[i];
    const bool is_candidate = view.candidates[i] != 0;
    const float share = view.labels[i] == 0 && !is_candidate ? 0.0f : (is_candidate ? 0.6f : 0.2f);
    const Eigen::Vector3f color = labelColor(is_candidate ? view.candidates[i] : view.labels[i]);
    for (int c = 0; c < 3; ++c)
      image.data[3 * i + static_cast<std::size_t>(c)] =
          static_cast<std::uint8_t>(std::lround((1.0f - share) * gray + share * 255.0f * color[c]));
  }
  return image;
}
}  // namespace bin_picking_ros
