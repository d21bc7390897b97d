// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/reference_choice.hpp"

#include "bin_picking_perception/common/kd_tree.hpp"

namespace bin_picking
{
namespace
{
/// A point with its normal, turned about the axis of revolution into one half-plane; as it is where there is no axis.
struct Oriented
{
  Eigen::Vector3f point;
  Eigen::Vector3f normal;
};

Oriented inHalfPlane(const Oriented& p, const Symmetry& symmetry)
{
  if (!symmetry.continuous)
    return p;
  const Eigen::Vector3f axis = symmetry.continuous->direction.cast<float>();
  const Eigen::Vector3f from_origin = p.point - symmetry.continuous->origin.cast<float>();
  const float height = from_origin.dot(axis);
  const Eigen::Vector3f radial = from_origin - height * axis;
  const float radius = radial.norm();
  const Eigen::Vector3f outwards = radius > 1e-6f ? Eigen::Vector3f(radial / radius) : axis.unitOrthogonal();
  return {{radius, height, 0}, {p.normal.dot(outwards), p.normal.dot(axis), p.normal.dot(axis.cross(outwards))}};
}
}  // namespace

std::vector<std::uint32_t> referencesUpToSymmetry(const OrientedPoints& points, const Symmetry& symmetry,
                                                  double spacing)
{
  constexpr float SAME_NORMAL = 0.8660254f;  // 30 degrees
  if (symmetry.trivial())
    return {};
  OrientedPoints folded;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Oriented p = inHalfPlane({points.points[i], points.normals[i]}, symmetry);
    folded.points.push_back(p.point);
    folded.normals.push_back(p.normal);
  }
  const KdTree tree(folded.points);
  std::vector<bool> covered(points.size(), false);
  std::vector<std::uint32_t> references;
  std::vector<int> near;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    if (covered[i])
      continue;
    references.push_back(static_cast<std::uint32_t>(i));
    for (const Pose& element : symmetry.discrete)
    {
      // The point itself covers only itself and what it turns into: neighbours are other points.
      const bool itself = &element == &symmetry.discrete.front() && !symmetry.continuous;
      const Oriented image = inHalfPlane({(element * points.points[i].cast<double>()).cast<float>(),
                                          (element.linear() * points.normals[i].cast<double>()).cast<float>()},
                                         symmetry);
      tree.radiusSearch(image.point, itself ? 0.0f : static_cast<float>(spacing), near);
      for (const int k : near)
        if (folded.normals[static_cast<std::size_t>(k)].dot(image.normal) > SAME_NORMAL)
          covered[static_cast<std::size_t>(k)] = true;
    }
  }
  return references;
}
}  // namespace bin_picking
