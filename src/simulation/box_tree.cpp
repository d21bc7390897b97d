// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "box_tree.hpp"

#include <algorithm>
#include <numeric>

namespace bin_picking::simulation
{
namespace
{
constexpr std::uint32_t LEAF_SIZE = 4;
}

BoxTree::BoxTree(const std::vector<Eigen::AlignedBox3d>& boxes) : order_(boxes.size())
{
  std::iota(order_.begin(), order_.end(), 0u);
  build(boxes, 0, static_cast<std::uint32_t>(boxes.size()));
  boxes_.reserve(boxes.size());
  for (const std::uint32_t k : order_)
    boxes_.push_back(boxes[k]);
}

std::uint32_t BoxTree::build(const std::vector<Eigen::AlignedBox3d>& boxes, std::uint32_t begin, std::uint32_t end)
{
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  Node node;
  node.begin = begin;
  node.end = end;
  Eigen::AlignedBox3d centers;
  for (std::uint32_t k = begin; k < end; ++k)
  {
    node.box.extend(boxes[order_[k]]);
    centers.extend(boxes[order_[k]].center());
  }
  nodes_.push_back(node);
  if (end - begin <= LEAF_SIZE)
    return index;
  Eigen::Index axis = 0;
  centers.sizes().maxCoeff(&axis);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     const double at_a = boxes[a].center()[axis];
                     const double at_b = boxes[b].center()[axis];
                     return at_a != at_b ? at_a < at_b : a < b;
                   });
  nodes_[index].left = build(boxes, begin, middle);
  nodes_[index].right = build(boxes, middle, end);
  return index;
}
}  // namespace bin_picking::simulation
