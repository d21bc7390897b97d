// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace bin_picking::simulation
{
/// Finds those of many boxes that meet another: a tree of bounding boxes, halved at the median.
class BoxTree
{
public:
  explicit BoxTree(const std::vector<Eigen::AlignedBox3d>& boxes);

  const Eigen::AlignedBox3d& bounds() const { return nodes_.front().box; }

  /// Calls use(index) for every box that meets `wanted`, touching included, in an order that depends on the tree only.
  template <typename Use>
  void visit(const Eigen::AlignedBox3d& wanted, const Use& use) const
  {
    std::vector<std::uint32_t> open = {0};
    while (!open.empty())
    {
      const Node& node = nodes_[open.back()];
      open.pop_back();
      if (!node.box.intersects(wanted))
        continue;
      if (node.right != 0)
      {
        open.push_back(node.right);
        open.push_back(node.left);
        continue;
      }
      for (std::uint32_t k = node.begin; k < node.end; ++k)
        if (boxes_[k].intersects(wanted))
          use(static_cast<std::size_t>(order_[k]));
    }
  }

private:
  struct Node
  {
    Eigen::AlignedBox3d box;
    std::uint32_t begin = 0;  ///< of the boxes below, in order_
    std::uint32_t end = 0;
    std::uint32_t left = 0;
    std::uint32_t right = 0;  ///< 0: a leaf
  };

  std::uint32_t build(const std::vector<Eigen::AlignedBox3d>& boxes, std::uint32_t begin, std::uint32_t end);

  std::vector<std::uint32_t> order_;
  std::vector<Eigen::AlignedBox3d> boxes_;  ///< in that order
  std::vector<Node> nodes_;
};
}  // namespace bin_picking::simulation
