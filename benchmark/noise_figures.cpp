// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "noise_figures.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace bin_picking
{
namespace
{
constexpr int SMALL_TILE = 12;
constexpr int LARGE_TILE = 32;
constexpr std::array<int, 4> LAGS = {1, 2, 4, 8};
constexpr double JUMP = 0.012;     // metres between the two sides of an edge
constexpr int MAX_GAP = 12;        // pixels; what is wider is a shadow, not the loss at an edge
constexpr double MIXED_STEEP = 5;  // pitches per pixel: surfaces are not seen that flat (79 degrees)
constexpr int SMALL_HOLE = 30;     // pixels
constexpr double NONE = std::numeric_limits<double>::quiet_NaN();

struct Tile
{
  double rms = 0;
  Eigen::MatrixXd residuals;  // metres
};

/// Deviation of a fully measured square from a polynomial in 1 / z, in which a plane is linear. False: not all
/// measured.
bool fitTile(const DepthGrid& grid, int u0, int v0, int side, bool quadratic, Tile& tile)
{
  const int terms = quadratic ? 6 : 3;
  Eigen::MatrixXd basis(side * side, terms);
  Eigen::VectorXd inverse_depth(side * side);
  for (int row = 0, v = v0; v < v0 + side; ++v)
    for (int u = u0; u < u0 + side; ++u, ++row)
    {
      const int i = grid.index(u, v);
      if (!grid.valid(i))
        return false;
      const double a = (u - u0 - 0.5 * side) / side;
      const double b = (v - v0 - 0.5 * side) / side;
      basis.row(row).head(3) << 1, a, b;
      if (quadratic)
        basis.row(row).tail(3) << a * a, a * b, b * b;
      inverse_depth[row] = 1 / static_cast<double>(grid.z[static_cast<std::size_t>(i)]);
    }
  const Eigen::MatrixXd normal_matrix = basis.transpose() * basis;
  const Eigen::VectorXd solution = normal_matrix.ldlt().solve(basis.transpose() * inverse_depth);
  const Eigen::VectorXd deviation =
      -(inverse_depth - basis * solution).cwiseQuotient(inverse_depth.cwiseProduct(inverse_depth));
  tile.rms = std::sqrt(deviation.squaredNorm() / (side * side - terms));
  tile.residuals = Eigen::Map<const Eigen::MatrixXd>(deviation.data(), side, side);
  return true;
}

/// The flattest share of the tiles, flattest first.
std::vector<Tile> flattestTiles(const DepthGrid& grid, int side, bool quadratic, double share)
{
  std::vector<Tile> tiles;
  Tile tile;
  for (int v = 0; v + side <= grid.height; v += side / 2)
    for (int u = 0; u + side <= grid.width; u += side / 2)
      if (fitTile(grid, u, v, side, quadratic, tile))
        tiles.push_back(tile);
  std::stable_sort(tiles.begin(), tiles.end(), [](const Tile& a, const Tile& b) { return a.rms < b.rms; });
  tiles.resize(static_cast<std::size_t>(std::ceil(share * static_cast<double>(tiles.size()))));
  return tiles;
}

double medianNoise(const std::vector<Tile>& tiles) { return tiles.empty() ? NONE : tiles[tiles.size() / 2].rms; }

double correlationAt(const std::vector<Tile>& tiles, int lag)
{
  double product = 0;
  double square = 0;
  for (const Tile& tile : tiles)
  {
    const Eigen::MatrixXd& r = tile.residuals;
    const Eigen::Index n = r.rows() - lag;
    product += r.topRows(n).cwiseProduct(r.bottomRows(n)).mean() + r.leftCols(n).cwiseProduct(r.rightCols(n)).mean();
    square += 2 * r.squaredNorm() / static_cast<double>(r.size());
  }
  return tiles.empty() ? NONE : product / square;
}

struct EdgeCounts
{
  int jumps = 0;
  int closed = 0;
  int lost_pixels = 0;
  int mixed_pixels = 0;
};

/// Walks along a row or column: from a measured pixel to the next one on a surface, over what is lost and mixed.
void countEdges(const DepthGrid& grid, int start, int step, int length, EdgeCounts& counts)
{
  const auto depth = [&](int k) { return static_cast<double>(grid.z[static_cast<std::size_t>(start + k * step)]); };
  const auto steep = [&](int a, int b) {
    return std::abs(depth(b) - depth(a)) > MIXED_STEEP * (b - a) * grid.pitch(std::min(depth(a), depth(b)));
  };
  int last = -1;  // on the surface before
  int mixed = 0;
  for (int k = 0; k < length; ++k)
  {
    if (std::isnan(depth(k)))
      continue;
    const bool ramp = last >= 0 && k + 1 < length && !std::isnan(depth(k + 1)) && steep(last, k) && steep(k, k + 1) &&
                      (depth(k) - depth(last)) * (depth(k + 1) - depth(k)) > 0;
    if (ramp && k - last - 1 <= MAX_GAP)
    {
      ++mixed;
      continue;
    }
    const int gap = last >= 0 ? k - last - 1 - mixed : 0;
    if (last >= 0 && k - last - 1 <= MAX_GAP && std::abs(depth(k) - depth(last)) > JUMP && steep(last, k))
    {
      ++counts.jumps;
      counts.closed += gap == 0 ? 1 : 0;
      counts.lost_pixels += gap;
      counts.mixed_pixels += mixed;
    }
    last = k;
    mixed = 0;
  }
}

/// Number of pixels of the connected hole at `seed`, all marked as seen.
int holeSize(const DepthGrid& grid, int seed, std::vector<bool>& seen)
{
  std::vector<int> open = {seed};
  seen[static_cast<std::size_t>(seed)] = true;
  int size = 0;
  while (!open.empty())
  {
    const int i = open.back();
    open.pop_back();
    ++size;
    const int u = i % grid.width;
    const int v = i / grid.width;
    for (const auto& [a, b] : {std::pair(u + 1, v), std::pair(u - 1, v), std::pair(u, v + 1), std::pair(u, v - 1)})
      if (grid.inside(a, b) && !grid.valid(grid.index(a, b)) && !seen[static_cast<std::size_t>(grid.index(a, b))])
      {
        seen[static_cast<std::size_t>(grid.index(a, b))] = true;
        open.push_back(grid.index(a, b));
      }
  }
  return size;
}

double smallHoleShare(const DepthGrid& grid)
{
  std::vector<bool> seen(grid.size(), false);
  int lost = 0;
  for (int i = 0; i < static_cast<int>(grid.size()); ++i)
    if (!grid.valid(i) && !seen[static_cast<std::size_t>(i)])
    {
      const int size = holeSize(grid, i, seen);
      lost += size <= SMALL_HOLE ? size : 0;
    }
  return static_cast<double>(lost) / static_cast<double>(grid.size());
}

void measureEdges(const DepthGrid& grid, NoiseFigures& figures)
{
  EdgeCounts counts;
  for (int v = 0; v < grid.height; ++v)
    countEdges(grid, v * grid.width, 1, grid.width, counts);
  for (int u = 0; u < grid.width; ++u)
    countEdges(grid, u, grid.width, grid.height, counts);
  const double jumps = counts.jumps > 0 ? counts.jumps : NONE;
  figures.edge_gap = counts.lost_pixels / jumps;
  figures.closed_edges = counts.closed / jumps;
  figures.mixed_pixels = counts.mixed_pixels / jumps;
}
}  // namespace

NoiseFigures noiseFigures(const DepthGrid& grid)
{
  NoiseFigures figures;
  std::vector<float> depths;
  std::copy_if(grid.z.begin(), grid.z.end(), std::back_inserter(depths), [](float z) { return !std::isnan(z); });
  figures.valid_share = static_cast<double>(depths.size()) / static_cast<double>(grid.size());
  figures.median_depth = NONE;
  if (!depths.empty())
  {
    const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
    std::nth_element(depths.begin(), middle, depths.end());
    figures.median_depth = static_cast<double>(*middle);
  }
  const std::vector<Tile> large = flattestTiles(grid, LARGE_TILE, false, 0.25);
  figures.small_tile_noise = medianNoise(flattestTiles(grid, SMALL_TILE, false, 0.25));
  figures.large_tile_noise = medianNoise(large);
  figures.curved_noise = medianNoise(flattestTiles(grid, SMALL_TILE, true, 0.5));
  for (std::size_t k = 0; k < LAGS.size(); ++k)
    figures.correlation[k] = correlationAt(large, LAGS[k]);
  measureEdges(grid, figures);
  figures.small_holes = smallHoleShare(grid);
  return figures;
}
}  // namespace bin_picking
