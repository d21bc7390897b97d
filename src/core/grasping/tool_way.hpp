// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "bin_picking_perception/grasping/tool_shape.hpp"
#include "body_sweep.hpp"

namespace bin_picking
{
/// A tool on a straight way, and the worst that its pieces have met so far. For one thread; the tool must outlive it.
class ToolWay
{
public:
  /// \param motion_camera metres
  ToolWay(const ToolShape& tool, const Pose& T_camera_tool0, const Eigen::Vector3d& motion_camera)
      : tool_(tool), T_camera_tool0_(T_camera_tool0), motion_camera_(motion_camera), covered_(tool.size())
  {}

  const Pose& T_camera_tool0() const { return T_camera_tool0_; }
  const Eigen::Vector3d& motion_camera() const { return motion_camera_; }
  const ToolPiece& piece(std::size_t i) const { return tool_[i]; }

  /// What a piece covers; worked out when first asked, because the bin alone rules out many ways.
  const BodySweep& covered(std::size_t i)
  {
    if (!covered_[i])
    {
      ConvexBody body = transformed(tool_[i].shape, T_camera_tool0_);
      covered_[i].emplace(motion_camera_ == Eigen::Vector3d::Zero() ? std::move(body) : swept(body, motion_camera_));
    }
    return *covered_[i];
  }

  /// Keeps the worst of what each piece meets: meets(i). \return whether the way is free so far
  template <typename Meets>
  bool meet(const Meets& meets)
  {
    for (std::size_t i = 0; i < tool_.size(); ++i)
      if (const Encounter met = meets(i); isWorse(met, worst_))
      {
        worst_ = met;
        body_ = &tool_[i].body;
      }
    return worst_.free();
  }

  const Encounter& worst() const { return worst_; }
  /// Name of the body that met the worst; empty if none met anything.
  std::string body() const { return body_ ? *body_ : std::string(); }

private:
  const ToolShape& tool_;
  Pose T_camera_tool0_;
  Eigen::Vector3d motion_camera_;
  std::vector<std::optional<BodySweep>> covered_;
  Encounter worst_;
  const std::string* body_ = nullptr;
};
}  // namespace bin_picking
