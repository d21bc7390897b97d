// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "grip_contact.hpp"

#include <cmath>
#include <cstdio>

#include "bin_picking_perception/common/figures.hpp"

namespace bin_picking::simulation
{
namespace
{
// Of a patch that holds, so much has to lie within the friction cone: the rest may be roundings and chamfers.
constexpr double MIN_SHARE = 0.5;

// Faces that are turned further away from the finger than this are cut by the pad's outline, not touched by it.
constexpr double MIN_FACING = 0.1;  // cosine

using Polygon = std::vector<Eigen::Vector3d>;

/// What is left of a polygon inside a plane (Sutherland and Hodgman 1974).
Polygon clipped(const Polygon& polygon, const Eigen::Vector4d& plane)
{
  const auto height = [&plane](const Eigen::Vector3d& p) { return plane.head<3>().dot(p) + plane[3]; };
  Polygon result;
  for (std::size_t k = 0; k < polygon.size(); ++k)
  {
    const Eigen::Vector3d& a = polygon[k];
    const Eigen::Vector3d& b = polygon[(k + 1) % polygon.size()];
    const double at_a = height(a);
    const double at_b = height(b);
    if (at_a <= 0)
      result.push_back(a);
    if ((at_a < 0 && at_b > 0) || (at_a > 0 && at_b < 0))
      result.push_back(a + (b - a) * at_a / (at_a - at_b));
  }
  return result;
}

/// Of the cosine.
std::string angleText(double cosine) { return degrees(std::acos(std::min(1.0, cosine)), 0); }
}  // namespace

void addContact(ContactPatch& patch, const PlacedMesh& target, const ConvexBody& pad_bin,
                const Eigen::Vector3d& outwards_bin, const GripTrialParameters& parameters)
{
  const ConvexBody pad = transformed(moved(pad_bin, -parameters.contact_depth * outwards_bin), target.T_mesh_bin);
  const Eigen::Vector3d outwards = target.T_mesh_bin.linear() * outwards_bin;
  const double cone = 1 / std::hypot(1, parameters.friction);  // cosine of the friction angle
  target.mesh->tree().visit(boundsOf(pad), [&](std::size_t k) {
    const Triangle& t = target.mesh->triangles()[k];
    const double facing = (t[1] - t[0]).cross(t[2] - t[0]).normalized().dot(outwards);
    if (!(facing > MIN_FACING))
      return;
    Polygon polygon(t.begin(), t.end());
    for (std::size_t p = 0; p < pad.planes.size() && polygon.size() > 2; ++p)
      polygon = clipped(polygon, pad.planes[p]);
    for (std::size_t i = 2; i < polygon.size(); ++i)
    {
      const double area = 0.5 * (polygon[i - 1] - polygon[0]).cross(polygon[i] - polygon[0]).norm();
      patch.area += area;
      patch.inside_cone += facing >= cone ? area : 0;
      patch.moment += area * (target.T_bin_mesh * ((polygon[0] + polygon[i - 1] + polygon[i]) / 3));
    }
  });
}

std::string judgeContacts(const ContactPatch& right, const ContactPatch& left, const PlacedMesh& target,
                          const Eigen::Vector3d& closing_bin, const GripTrialParameters& parameters)
{
  const double cone = 1 / std::hypot(1, parameters.friction);
  for (const ContactPatch* patch : {&right, &left})
    if (!(patch->inside_cone >= MIN_SHARE * patch->area) || patch->area == 0)
    {
      const int share = patch->area > 0 ? static_cast<int>(100 * patch->inside_cone / patch->area) : 0;
      return "The fingers slip off " + target.name + ": of what a pad touches, " + std::to_string(share) +
             " % lie within the friction cone of " + angleText(cone) + ", half is needed (friction).";
    }
  const double along = (right.middle() - left.middle()).normalized().dot(closing_bin);
  if (along >= cone)
    return "";
  return "The fingers turn " + target.name + " away: the line between their contacts leans by " + angleText(along) +
         " against the closing direction, " + angleText(cone) + " are allowed (friction).";
}

ConvexBody moved(ConvexBody body, const Eigen::Vector3d& motion)
{
  for (Eigen::Vector3d& p : body.vertices)
    p += motion;
  for (Eigen::Vector4d& plane : body.planes)
    plane[3] -= plane.head<3>().dot(motion);
  return body;
}
}  // namespace bin_picking::simulation
