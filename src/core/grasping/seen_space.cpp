// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "seen_space.hpp"

#include <algorithm>
#include <cmath>

namespace bin_picking
{
namespace
{
constexpr double MAX_EXTENSION = 2;  // of the picture's size, to either side

int wholeBlocks(int pixels) { return (pixels + BLOCK - 1) / BLOCK * BLOCK; }

std::vector<Eigen::Vector3d> cornersOf(const Bin& bin)
{
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      for (const double z : {0.0, 1.0})
        corners.push_back(bin.T_camera_bin * bin.inner_size.cwiseProduct(Eigen::Vector3d(x, y, z)));
  return corners;
}
}  // namespace

SeenSpace::SeenSpace(const DepthGrid& measured, const Bin* bin, const ObstacleParameters& parameters,
                     const Executor& executor)
    : surface_clearance_(static_cast<float>(parameters.surface_clearance)),
      unseen_entry_(static_cast<float>(parameters.unseen_entry)),
      shadow_entry_(static_cast<float>(parameters.shadow_entry))
{
  layOut(measured, bin);
  bridgeGaps(measured, executor);
  if (bin)
    hideBin(*bin, executor);
  constexpr std::size_t STEPS = 3;
  executor.forEach(STEPS, [&](std::size_t step) {
    if (step == 0)
      allowed_ = allowedDepth(unseen_entry_);
    else if (step == 1)
      allowed_own_ = allowedDepth(shadow_entry_);
    else
      boundBlocks();
  });
}

void SeenSpace::layOut(const DepthGrid& measured, const Bin* bin)
{
  const PinholeCamera& camera = measured.camera;
  Eigen::AlignedBox2d picture(Eigen::Vector2d::Zero(), Eigen::Vector2d(measured.width, measured.height));
  const Eigen::Vector2d most = MAX_EXTENSION * picture.sizes();
  const Eigen::AlignedBox2d largest(-most, picture.max() + most);
  if (bin)
    for (const Eigen::Vector3d& corner : cornersOf(*bin))  // beside the camera or behind it: the bin may be on any ray
      picture.extend(corner.z() > static_cast<double>(MIN_DEPTH) ? Eigen::AlignedBox2d(camera.project(corner))
                                                                 : largest);
  picture = picture.intersection(largest);
  left_ = static_cast<int>(std::ceil(-picture.min().x()));
  top_ = static_cast<int>(std::ceil(-picture.min().y()));
  width_ = left_ + static_cast<int>(std::ceil(picture.max().x()));
  height_ = top_ + static_cast<int>(std::ceil(picture.max().y()));
  stride_ = wholeBlocks(width_);
  fx_ = static_cast<float>(camera.fx);
  fy_ = static_cast<float>(camera.fy);
  step_ = {1 / fx_, 1 / fy_};
  cx_ = static_cast<float>(camera.cx + left_);
  cy_ = static_cast<float>(camera.cy + top_);
  const auto pixels = static_cast<std::size_t>(stride_ * wholeBlocks(height_));
  depth_.assign(pixels, FAR_AWAY);
  measured_.assign(pixels, 0);
  hidden_by_.assign(pixels, -1);
}

/// The largest depth within `entry` along rows and columns, and `entry` more: how far a body may go that may be off the
/// free rays by that.
std::vector<float> SeenSpace::allowedDepth(float entry) const
{
  float farthest = 0;
  for (std::size_t i = 0; i < depth_.size(); ++i)
    if (measured_[i] != 0)
      farthest = std::max(farthest, depth_[i]);
  const int reach = farthest > 0 ? static_cast<int>(entry * std::sqrt(fx_ * fy_) / farthest) : 0;
  const auto stride = static_cast<std::size_t>(stride_);
  const auto width = static_cast<std::size_t>(width_);
  const auto margin = static_cast<std::size_t>(reach);
  const std::size_t window = 2 * margin + 1;
  std::vector<float> allowed(depth_.size() + 2 * margin * stride, 0.0f);
  std::vector<float> row(width + 2 * margin);
  for (std::size_t v = 0; v < static_cast<std::size_t>(height_); ++v)
  {
    std::fill(row.begin(), row.end(), 0.0f);
    std::copy_n(&depth_[v * stride], width, row.begin() + reach);
    raiseToWindow(row.data(), row.size(), 1, window);
    std::copy_n(row.begin(), width, &allowed[(v + margin) * stride]);
  }
  raiseToWindow(allowed.data(), allowed.size(), stride, window);
  allowed.resize(depth_.size());
  for (float& depth : allowed)
    depth += entry;
  // What fills up the last blocks is no part of the picture.
  const auto rows = static_cast<std::size_t>(height_);
  std::fill(allowed.begin() + static_cast<std::ptrdiff_t>(rows * stride), allowed.end(), FAR_AWAY + entry);
  for (std::size_t v = 0; v < rows; ++v)
    std::fill_n(&allowed[v * stride + width], stride - width, FAR_AWAY + entry);
  return allowed;
}

void SeenSpace::boundBlocks()
{
  const std::size_t blocks = depth_.size() / (BLOCK * BLOCK);
  block_nearest_.assign(blocks + BLOCK, FAR_AWAY);  // BLOCK of them are read at once
  block_points_.assign(blocks, Sphere{});
  for (int v = 0; v < static_cast<int>(depth_.size()) / stride_; v += BLOCK)
    for (int u = 0; u < stride_; u += BLOCK)
    {
      float nearest = FAR_AWAY;
      float nearest_point = FAR_AWAY;
      float farthest_point = 0;
      for (int row = 0; row < BLOCK; ++row)
        for (std::size_t i = index(u, v + row); i < index(u + BLOCK, v + row); ++i)
        {
          nearest = std::min(nearest, depth_[i]);
          nearest_point = std::min(nearest_point, measured_[i] != 0 ? depth_[i] : FAR_AWAY);
          farthest_point = std::max(farthest_point, measured_[i] != 0 ? depth_[i] : 0.0f);
        }
      block_nearest_[blockOf(u, v)] = nearest;
      block_points_[blockOf(u, v)] = aroundPoints(u, v, nearest_point, farthest_point);
    }
}

/// Around the corners of the block at the nearest and the farthest depth; where the nearest is the farther: nothing.
Sphere SeenSpace::aroundPoints(int u, int v, float nearest, float farthest) const
{
  if (nearest > farthest)
    return {Eigen::Vector3f::Zero(), -1};
  Eigen::AlignedBox3f box;
  for (const float depth : {nearest, farthest})
  {
    box.extend(Eigen::Vector3f(depth * ray(u, v)));
    box.extend(Eigen::Vector3f(depth * ray(u + BLOCK - 1, v + BLOCK - 1)));
  }
  return {box.center(), 0.5f * box.diagonal().norm()};
}
}  // namespace bin_picking
