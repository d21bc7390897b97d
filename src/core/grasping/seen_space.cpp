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
      shadow_entry_(static_cast<float>(parameters.shadow_entry)),
      unknown_entry_(static_cast<float>(parameters.unknown_entry))
{
  layOut(measured, bin);
  bridgeGaps(measured, executor);
  if (bin)
    hideBin(*bin, executor);
  allowed_unknown_ = allowedBehindUnknown(executor);
  const float farthest = boundBlocks(executor);
  allowed_ = allowedDepth(unseen_entry_, farthest, executor);
  allowed_own_ = allowedDepth(shadow_entry_, farthest, executor);
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
  const auto pixels = static_cast<std::size_t>(stride_) * static_cast<std::size_t>(wholeBlocks(height_));
  depth_.assign(pixels, FAR_AWAY);
  measured_.assign(pixels, 0);
  hidden_by_.assign(pixels, -1);
}

/// The largest depth within `entry` along rows and columns, and `entry` more: how far a body may go that may be off the
/// free rays by that. \param farthest of the measured points, where `entry` spans the fewest pixels
std::vector<float> SeenSpace::allowedDepth(float entry, float farthest, const Executor& executor) const
{
  const int reach = farthest > 0 ? static_cast<int>(entry * std::sqrt(fx_ * fy_) / farthest) : 0;
  const auto margin = static_cast<std::size_t>(reach);
  const auto stride = static_cast<std::size_t>(stride_);
  const auto width = static_cast<std::size_t>(width_);
  const auto height = static_cast<std::size_t>(height_);
  // What fills up the last blocks is no part of the picture.
  std::vector<float> allowed(depth_.size(), FAR_AWAY + entry);
  executor.forEachBundle(height, 32, [&](std::size_t begin, std::size_t end) {
    std::vector<float> row(width + 2 * margin);
    for (std::size_t v = begin; v < end; ++v)
    {
      std::fill(row.begin(), row.end(), 0.0f);
      std::copy_n(&depth_[v * stride], width, &row[margin]);
      raiseToWindow(row.data(), row.size(), 1, 2 * margin + 1);
      std::copy_n(row.data(), width, &allowed[v * stride]);
    }
  });
  // Few columns at a time, so that all their rows stay in the processor's cache.
  constexpr std::size_t STRIP = 32;
  executor.forEachBundle(width, STRIP, [&](std::size_t begin, std::size_t end) {
    std::vector<float> strip((height + 2 * margin) * STRIP, 0.0f);
    for (std::size_t v = 0; v < height; ++v)
      std::copy_n(&allowed[v * stride + begin], end - begin, &strip[(v + margin) * STRIP]);
    raiseToWindow(strip.data(), strip.size(), STRIP, 2 * margin + 1);
    for (std::size_t v = 0; v < height; ++v)
      for (std::size_t k = 0; k < end - begin; ++k)
        allowed[v * stride + begin + k] = strip[v * STRIP + k] + entry;
  });
  return allowed;
}

/// What is not known may fill the whole gap beside it: its flank, seen at a grazing angle, was not measured either.
std::vector<float> SeenSpace::allowedBehindUnknown(const Executor& executor) const
{
  constexpr std::size_t AT_A_TIME = 1 << 14;
  std::vector<float> allowed(depth_.size());
  executor.forEachBundle(depth_.size(), AT_A_TIME, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      allowed[i] = (hidden_by_[i] < 0 ? depth_[i] : depth_[static_cast<std::size_t>(hidden_by_[i])]) + unknown_entry_;
  });
  return allowed;
}

/// \return the depth of the farthest measured point; 0: there is none
float SeenSpace::boundBlocks(const Executor& executor)
{
  const std::size_t blocks = depth_.size() / (BLOCK * BLOCK);
  const int rows = static_cast<int>(depth_.size()) / stride_ / BLOCK;
  std::vector<float> farthest(static_cast<std::size_t>(rows), 0.0f);
  block_nearest_.assign(blocks + BLOCK, FAR_AWAY);  // BLOCK of them are read at once
  block_points_.assign(blocks, Sphere{});
  executor.forEach(farthest.size(), [&](std::size_t row) {
    const int v = static_cast<int>(row) * BLOCK;
    for (int u = 0; u < stride_; u += BLOCK)
    {
      const BlockDepths of = depthsOfBlock(&allowed_unknown_[index(u, v)], &depth_[index(u, v)],
                                           &measured_[index(u, v)], static_cast<std::size_t>(stride_), FAR_AWAY);
      block_nearest_[blockOf(u, v)] = of.least - unknown_entry_;  // where no limit begins earlier
      block_points_[blockOf(u, v)] = aroundPoints(u, v, of.nearest_point, of.farthest_point);
      farthest[row] = std::max(farthest[row], of.farthest_point);
    }
  });
  return farthest.empty() ? 0.0f : *std::max_element(farthest.begin(), farthest.end());
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
