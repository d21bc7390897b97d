// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "neighbourhood.hpp"

#include <algorithm>
#include <cmath>

namespace bin_picking
{
namespace
{
constexpr double PI = 3.14159265358979323846;
constexpr double MAX_NEIGHBOURS = 150;
}  // namespace

void padWithZeros(Neighbourhood& found)
{
  for (std::size_t k = found.size; k % Neighbourhood::LANES != 0; ++k)
    for (auto* plane : {&found.x, &found.y, &found.z, &found.nx, &found.ny, &found.nz, &found.weight})
      (*plane)[k] = 0;
}

void NeighbourSearch::find(const Eigen::Vector3f& centre, int pixel, Neighbourhood& found) const
{
  const auto i = static_cast<std::size_t>(pixel);
  const double radius_pixels = static_cast<double>(radius_) / grid_.pitch(static_cast<double>(grid_.z[i]));
  found.size = 0;
  found.stride =
      std::max(1, static_cast<int>(std::ceil(std::sqrt(PI * radius_pixels * radius_pixels / MAX_NEIGHBOURS))));
  const int step = found.stride * grid_.width;
  bool within = addRow(centre, pixel, found);
  for (int k = 1; within && k * found.stride <= runs_.up[i]; ++k)
    within = addRow(centre, pixel - k * step, found);
  within = true;
  for (int k = 1; within && k * found.stride <= runs_.down[i]; ++k)
    within = addRow(centre, pixel + k * step, found);
  padWithZeros(found);
}

/// The pixel and what lies left and right of it. \return whether the pixel itself is within the radius
bool NeighbourSearch::addRow(const Eigen::Vector3f& centre, int pixel, Neighbourhood& found) const
{
  if (!add(centre, pixel, found))
    return false;
  const auto i = static_cast<std::size_t>(pixel);
  for (int k = found.stride; k <= runs_.left[i] && add(centre, pixel - k, found); k += found.stride)
  {}
  for (int k = found.stride; k <= runs_.right[i] && add(centre, pixel + k, found); k += found.stride)
  {}
  return true;
}

/// \return whether the pixel is within the radius
bool NeighbourSearch::add(const Eigen::Vector3f& centre, int pixel, Neighbourhood& found) const
{
  const Eigen::Vector3f offset = grid_.point(pixel) - centre;
  if (offset.squaredNorm() > radius_ * radius_ || found.size == Neighbourhood::CAPACITY)
    return false;
  const Eigen::Vector3f& normal = normals_[static_cast<std::size_t>(pixel)];
  if (std::isnan(normal.x()))
    return true;  // a lone pixel: on the way, but no surface
  const std::size_t k = found.size++;
  found.x[k] = offset.x();
  found.y[k] = offset.y();
  found.z[k] = offset.z();
  found.nx[k] = normal.x();
  found.ny[k] = normal.y();
  found.nz[k] = normal.z();
  found.weight[k] = 1;
  return true;
}
}  // namespace bin_picking
