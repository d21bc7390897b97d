// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bullet_body.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <utility>

#include "convex_hull.hpp"

namespace bin_picking::simulation
{
namespace
{
/// Bullet rounds convex bodies by this much, metres; hulls are shrunk by it first, so that they keep their size.
constexpr double MARGIN = 0.0002;
/// By so much a corner may be missing: collisions take their time from the number of corners.
constexpr double CORNER_TOLERANCE = 0.0003;

/// Axes of the ellipsoid of inertia; moments: about them.
Eigen::Matrix3d principalAxes(const Eigen::Matrix3d& inertia, Eigen::Vector3d& moments)
{
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(inertia);
  moments = solver.eigenvalues();
  Eigen::Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0)
    axes.col(2) = -axes.col(2);
  return axes;
}
}  // namespace

btVector3 toBullet(const Eigen::Vector3d& metres)
{
  const Eigen::Vector3d units = metres * UNITS_PER_METRE;
  return btVector3(static_cast<btScalar>(units.x()), static_cast<btScalar>(units.y()),
                   static_cast<btScalar>(units.z()));
}

btTransform toBullet(const Pose& T)
{
  const Eigen::Quaterniond q(T.linear());
  return btTransform(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                  static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w())),
                     toBullet(T.translation()));
}

Pose fromBullet(const btTransform& T)
{
  const btQuaternion q = T.getRotation();
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(static_cast<double>(q.w()), static_cast<double>(q.x()), static_cast<double>(q.y()),
                                     static_cast<double>(q.z()))
                      .normalized()
                      .toRotationMatrix();
  const btVector3& t = T.getOrigin();
  pose.translation() =
      Eigen::Vector3d(static_cast<double>(t.x()), static_cast<double>(t.y()), static_cast<double>(t.z())) /
      UNITS_PER_METRE;
  return pose;
}

BulletShape::BulletShape(const RigidBodyShape& shape)
    : name(shape.name), radius(shape.radius), compound(std::make_unique<btCompoundShape>())
{
  Eigen::Vector3d moments;
  T_object_body.linear() = principalAxes(shape.inertia, moments);
  T_object_body.translation() = shape.center_of_mass;
  // At a density of one unit of mass per cubic unit: in a pile of equal density the density has no influence.
  mass = static_cast<btScalar>(shape.volume * std::pow(UNITS_PER_METRE, 3));
  moments *= std::pow(UNITS_PER_METRE, 5);
  inertia = btVector3(static_cast<btScalar>(moments.x()), static_cast<btScalar>(moments.y()),
                      static_cast<btScalar>(moments.z()));
  const Pose T_body_object = T_object_body.inverse();
  for (const ConvexPiece& piece : shape.pieces)
  {
    std::vector<Eigen::Vector3d> points;
    for (const Eigen::Vector3f& corner : piece)
      points.push_back(T_body_object * corner.cast<double>());
    // Shrinking first: it splits corners in which more than three faces meet.
    points = simplifiedHull(convexHull(points, MARGIN).vertices, CORNER_TOLERANCE);
    corners.insert(corners.end(), points.begin(), points.end());
    auto hull = std::make_unique<btConvexHullShape>();
    for (const Eigen::Vector3d& corner : points)
      hull->addPoint(toBullet(corner), false);
    hull->recalcLocalAabb();
    hull->setMargin(static_cast<btScalar>(MARGIN * UNITS_PER_METRE));
    compound->addChildShape(btTransform::getIdentity(), hull.get());
    pieces.push_back(std::move(hull));
  }
}
}  // namespace bin_picking::simulation
