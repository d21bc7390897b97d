// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "mesh_cutting.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "mesh_solid.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr double SAME = 1e-7;        // metres: a vertex so near to a cut lies on it
constexpr double FLAT_SHARE = 0.01;  // of the whole surface: flat faces from here on attract a cut

Eigen::Vector3d doubledArea(const Triangle& t) { return (t[1] - t[0]).cross(t[2] - t[0]); }

void clipTriangle(const Triangle& t, const Eigen::Vector3d& depth, int axis, double at, std::vector<Triangle>& kept)
{
  std::vector<Eigen::Vector3d> polygon;
  for (int i = 0; i < 3; ++i)
  {
    const int j = (i + 1) % 3;
    const auto a = static_cast<std::size_t>(i);
    const auto b = static_cast<std::size_t>(j);
    if (depth[i] >= 0)
      polygon.push_back(t[a]);
    if ((depth[i] < 0) != (depth[j] < 0))
    {
      Eigen::Vector3d cut = t[a] + (depth[i] / (depth[i] - depth[j])) * (t[b] - t[a]);
      cut[axis] = at;
      polygon.push_back(cut);
    }
  }
  for (std::size_t k = 2; k < polygon.size(); ++k)
    kept.push_back({polygon[0], polygon[k - 1], polygon[k]});
}

/// Places of flat faces square to the axis that make up a good share of the surface.
std::vector<double> flatFaces(const std::vector<Triangle>& surface, int axis, double grain)
{
  double whole = 0;
  std::map<long, double> area_at;
  for (const Triangle& t : surface)
  {
    const Eigen::Vector3d area = doubledArea(t);
    whole += area.norm();
    if (std::abs(area[axis]) > 0.999 * area.norm())
      area_at[std::lround(t[0][axis] / grain)] += area.norm();
  }
  std::vector<double> places;
  for (const auto& [place, area] : area_at)
    if (area > FLAT_SHARE * whole)
      places.push_back(static_cast<double>(place) * grain);
  return places;
}

/// Inner cuts along one axis, ascending.
std::vector<double> cutsAlong(const std::vector<Triangle>& surface, const Eigen::AlignedBox3d& box, int axis,
                              double size)
{
  const double low = box.min()[axis];
  const double high = box.max()[axis];
  const double nearest = 0.3 * size;
  std::vector<double> cuts;
  const auto add = [&](double at) {
    const bool free = std::all_of(cuts.begin(), cuts.end(), [&](double cut) { return std::abs(cut - at) > nearest; });
    if (free && at > low + nearest && at < high - nearest)
      cuts.push_back(at);
  };
  for (const double at : flatFaces(surface, axis, 1e-6))
    add(at);
  const int count = static_cast<int>(std::ceil((high - low) / size));
  for (int k = 1; k < count; ++k)
    add(low + (high - low) * k / count);
  std::sort(cuts.begin(), cuts.end());
  return cuts;
}

struct Slab
{
  Eigen::AlignedBox3d box;
  std::vector<Triangle> surface;
};

std::vector<Slab> cutAlong(const std::vector<Slab>& slabs, int axis, const std::vector<double>& cuts)
{
  std::vector<Slab> result;
  for (Slab rest : slabs)
  {
    for (const double at : cuts)
    {
      Slab below{rest.box, clip(rest.surface, axis, at, -1)};
      below.box.max()[axis] = at;
      result.push_back(std::move(below));
      rest.surface = clip(rest.surface, axis, at, 1);
      rest.box.min()[axis] = at;
    }
    result.push_back(std::move(rest));
  }
  return result;
}
}  // namespace

std::vector<Triangle> clip(const std::vector<Triangle>& surface, int axis, double at, int side)
{
  std::vector<Triangle> kept;
  for (const Triangle& t : surface)
  {
    const Eigen::Vector3d depth = side * (Eigen::Vector3d(t[0][axis], t[1][axis], t[2][axis]).array() - at);
    if (depth.minCoeff() < -SAME && depth.maxCoeff() > SAME)
      clipTriangle(t, depth, axis, at, kept);
    else if (depth.minCoeff() >= -SAME && (depth.maxCoeff() > SAME || side * doubledArea(t)[axis] < 0))
      kept.push_back(t);
  }
  return kept;
}

std::vector<Block> cutIntoBlocks(const TriangleMesh& mesh, double size)
{
  Slab whole;
  for (const auto& t : mesh.triangles)
    whole.surface.push_back(
        {mesh.vertices[t[0]].cast<double>(), mesh.vertices[t[1]].cast<double>(), mesh.vertices[t[2]].cast<double>()});
  for (const Triangle& t : whole.surface)
    for (const Eigen::Vector3d& corner : t)
      whole.box.extend(corner);
  std::vector<Slab> slabs = {whole};
  for (int axis = 0; axis < 3; ++axis)
    slabs = cutAlong(slabs, axis, cutsAlong(whole.surface, whole.box, axis, size));
  const SolidTest inside(mesh);
  std::vector<Block> blocks;
  for (const Slab& slab : slabs)
  {
    Block block{slab.box, {}};
    for (const Triangle& t : slab.surface)
      block.corners.insert(block.corners.end(), t.begin(), t.end());
    for (int k = 0; k < 8; ++k)  // of the box, where the solid goes on beyond it
    {
      const Eigen::Vector3d corner = slab.box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(k));
      if (inside(corner + 1e-5 * (slab.box.center() - corner)))
        block.corners.push_back(corner);
    }
    if (!block.corners.empty())
      blocks.push_back(std::move(block));
  }
  return blocks;
}
}  // namespace bin_picking::simulation
