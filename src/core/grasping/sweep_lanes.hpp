// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstddef>
#include <cstdint>

#include "body_sweep.hpp"

namespace bin_picking
{
constexpr int BLOCK = 8;  ///< pixels that are computed at once, and rows of a block

/// Which of BLOCK blocks of pixels, side by side, hold a ray on which a body, `around` larger, reaches as far as
/// nearest[k] of the block; some on which it does not may be among them. \param deepest how far the body reaches along
/// z \param ray of the first block's first pixel, z = 1 \param step of the rays from pixel to pixel \return a bit for
/// each block
unsigned mayMeet(const Planes& planes, float deepest, const Eigen::Vector3f& ray, const Eigen::Vector2f& step,
                 float around, const float* nearest);

/// A block of pixels and what a body does on their rays, row by row.
struct Lanes
{
  float depth[BLOCK][BLOCK];     ///< of the surface, metres along z
  float allowed[BLOCK][BLOCK];   ///< how far a body may go
  float distance[BLOCK][BLOCK];  ///< signed, of the surface's point from the body
  float beyond[BLOCK][BLOCK];    ///< how far the body goes beyond what is allowed, along z; <= 0: it does not
};

/// Fills distance and beyond. \param ray of the first pixel, z = 1 \param step of the rays' x from column to column,
/// and of their y from row to row \return a bit for each row in which any distance is less than `near`, or the body
/// goes beyond what is allowed
unsigned meet(const Planes& planes, const Eigen::Vector3f& ray, const Eigen::Vector2f& step, float near, Lanes& lanes);

/// Signed distances of points from a body; their number is a multiple of BLOCK.
void signedDistances(const Planes& planes, const float* x, const float* y, const float* z, std::size_t count,
                     float* distances);

/// Of a block of pixels.
struct BlockDepths
{
  float least;           ///< of all values
  float nearest_point;   ///< of those measured; `far_away` if there is none
  float farthest_point;  ///< 0 if there is none
};
/// \param values any, depth, measured: of the block's first pixel; rows are `stride` apart \param far_away no depth is
/// larger
BlockDepths depthsOfBlock(const float* values, const float* depth, const std::uint8_t* measured, std::size_t stride,
                          float far_away);

/// Each value becomes the largest of `window` values, itself the first, each `step` after the one before. Values beyond
/// the end do not count. In place.
void raiseToWindow(float* values, std::size_t count, std::size_t step, std::size_t window);
}  // namespace bin_picking
