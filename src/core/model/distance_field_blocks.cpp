// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <cstring>

#include "../common/simd.hpp"
#include "bin_picking_perception/model/distance_field.hpp"

// Cells are found and interpolated in vectors; only the eight values of each, which lie scattered in memory, are read
// one by one.

namespace bin_picking
{
namespace
{
constexpr std::size_t BLOCK = DistanceField::BLOCK;

/// A field without its values, as plain numbers that a loop can keep in registers.
struct Lattice
{
  float low_x, low_y, low_z;
  float limit_x, limit_y, limit_z;
  float inverse_cell;
  float step;
  float band;
  std::int32_t columns;
  std::int32_t rows;
};

/// The values at both ends of a cell's edge along x.
using Edges = std::array<std::int16_t, 2 * BLOCK>;

/// The cells around places.
struct Cells
{
  DistanceField::Numbers share_x, share_y, share_z;  ///< of the cell, from its lowest corner
  std::array<std::uint8_t, BLOCK> inside;            ///< of the grid
  std::array<std::int32_t, BLOCK> lowest;            ///< index of that corner; 0 outside
  Edges e00, e10, e01, e11;                          ///< second in y, and in z
};

BIN_PICKING_SIMD void findCells(const DistanceField::Places& places, const Lattice& lattice, Cells& cells)
{
  const Lattice l = lattice;
  for (std::size_t k = 0; k < BLOCK; ++k)
  {
    const float qx = (places.x[k] - l.low_x) * l.inverse_cell;
    const float qy = (places.y[k] - l.low_y) * l.inverse_cell;
    const float qz = (places.z[k] - l.low_z) * l.inverse_cell;
    const bool inside = (qx >= 0) & (qy >= 0) & (qz >= 0) & (qx < l.limit_x) & (qy < l.limit_y) & (qz < l.limit_z);
    const float x = inside ? qx : 0;
    const float y = inside ? qy : 0;
    const float z = inside ? qz : 0;
    const auto ix = static_cast<std::int32_t>(x);
    const auto iy = static_cast<std::int32_t>(y);
    const auto iz = static_cast<std::int32_t>(z);
    cells.share_x[k] = x - static_cast<float>(ix);
    cells.share_y[k] = y - static_cast<float>(iy);
    cells.share_z[k] = z - static_cast<float>(iz);
    cells.inside[k] = static_cast<std::uint8_t>(inside);
    cells.lowest[k] = (iz * l.rows + iy) * l.columns + ix;
  }
}

void readValues(const std::int16_t* values, const Lattice& lattice, Cells& cells)
{
  const auto row = static_cast<std::size_t>(lattice.columns);
  const std::size_t layer = row * static_cast<std::size_t>(lattice.rows);
  constexpr std::size_t TWO = 2 * sizeof(std::int16_t);
  for (std::size_t k = 0; k < BLOCK; ++k)
  {
    const std::int16_t* lowest = values + cells.lowest[k];
    std::memcpy(&cells.e00[2 * k], lowest, TWO);
    std::memcpy(&cells.e10[2 * k], lowest + row, TWO);
    std::memcpy(&cells.e01[2 * k], lowest + layer, TWO);
    std::memcpy(&cells.e11[2 * k], lowest + layer + row, TWO);
  }
}

BIN_PICKING_INLINE float mix(float a, float b, float share) { return a + share * (b - a); }

struct Edge
{
  float value;
  float slope;
};

BIN_PICKING_INLINE Edge edgeAt(const Edges& edges, std::size_t k, float share)
{
  const auto begin = static_cast<float>(edges[2 * k]);
  const float slope = static_cast<float>(edges[2 * k + 1]) - begin;
  return {begin + share * slope, slope};
}

BIN_PICKING_SIMD void interpolate(const Cells& cells, const Lattice& lattice, DistanceField::Numbers& distances)
{
  const Lattice l = lattice;
  for (std::size_t k = 0; k < BLOCK; ++k)
  {
    const float x = cells.share_x[k];
    const float y = cells.share_y[k];
    const float bottom = mix(edgeAt(cells.e00, k, x).value, edgeAt(cells.e10, k, x).value, y);
    const float top = mix(edgeAt(cells.e01, k, x).value, edgeAt(cells.e11, k, x).value, y);
    distances[k] = cells.inside[k] != 0 ? l.step * mix(bottom, top, cells.share_z[k]) : l.band;
  }
}

BIN_PICKING_SIMD void differentiate(const Cells& cells, const Lattice& lattice, DistanceField::Samples& samples)
{
  const Lattice l = lattice;
  const float unit = l.step * l.inverse_cell;
  for (std::size_t k = 0; k < BLOCK; ++k)
  {
    const float y = cells.share_y[k];
    const float z = cells.share_z[k];
    const Edge e00 = edgeAt(cells.e00, k, cells.share_x[k]);
    const Edge e10 = edgeAt(cells.e10, k, cells.share_x[k]);
    const Edge e01 = edgeAt(cells.e01, k, cells.share_x[k]);
    const Edge e11 = edgeAt(cells.e11, k, cells.share_x[k]);
    const float bottom = mix(e00.value, e10.value, y);
    const float top = mix(e01.value, e11.value, y);
    const bool inside = cells.inside[k] != 0;
    samples.distance[k] = inside ? l.step * mix(bottom, top, z) : l.band;
    samples.gradient_x[k] = inside ? unit * mix(mix(e00.slope, e10.slope, y), mix(e01.slope, e11.slope, y), z) : 0;
    samples.gradient_y[k] = inside ? unit * mix(e10.value - e00.value, e11.value - e01.value, z) : 0;
    samples.gradient_z[k] = inside ? unit * (top - bottom) : 0;
  }
}
}  // namespace

template <typename Finish>
void DistanceField::inCells(const Places& places, const Finish& finish) const
{
  const Lattice lattice = {low_.x(),
                           low_.y(),
                           low_.z(),
                           limit_.x(),
                           limit_.y(),
                           limit_.z(),
                           inverse_cell_,
                           step_,
                           band_,
                           static_cast<std::int32_t>(columns_),
                           static_cast<std::int32_t>(rows_)};
  Cells cells;
  findCells(places, lattice, cells);
  readValues(values_.data(), lattice, cells);
  finish(cells, lattice);
}

void DistanceField::at(const Places& places, Numbers& distances) const
{
  if (empty())
    distances.fill(band_);
  else
    inCells(places, [&](const Cells& cells, const Lattice& lattice) { interpolate(cells, lattice, distances); });
}

void DistanceField::sample(const Places& places, Samples& samples) const
{
  if (empty())
  {
    samples = {};
    samples.distance.fill(band_);
  }
  else
    inCells(places, [&](const Cells& cells, const Lattice& lattice) { differentiate(cells, lattice, samples); });
}
}  // namespace bin_picking
