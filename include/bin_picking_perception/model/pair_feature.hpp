// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"

namespace bin_picking
{
/// Which features the table is keyed by.
enum class FeatureKind
{
  Ppf,               ///< the first four of Equation 5 (Drost et al. 2010)
  CurPpfUnweighted,  ///< all six, every vote counts 1
  CurPpf,            ///< all six, votes weighted by Equation 8
  Auto               ///< CurPpf where the part's curvature pays, otherwise Ppf; a trained model has one of them
};

/// Equation 5: (|d|, angle(n1, d), angle(n2, d), angle(n1, n2), q1, q2) with d = p2 - p1. Asymmetric:
/// feature(1, 2) is not feature(2, 1).
struct PairFeature
{
  float distance = 0;     ///< metres, > 0
  float angle_n1_d = 0;   ///< [0, pi]
  float angle_n2_d = 0;   ///< [0, pi]
  float angle_n1_n2 = 0;  ///< [0, pi]
  float q1 = 0;
  float q2 = 0;
};

/// Angle between unit vectors, exact also near 0 and pi.
float angleBetween(const Eigen::Vector3f& a, const Eigen::Vector3f& b);

PairFeature pairFeature(const Eigen::Vector3f& p1, const Eigen::Vector3f& n1, float q1, const Eigen::Vector3f& p2,
                        const Eigen::Vector3f& n2, float q2);

/// Rigid motion that puts p into the origin and turns its unit normal n onto the x axis: T_m->g and T_s->g of
/// Equation 6.
Eigen::Isometry3f alignToLocalFrame(const Eigen::Vector3f& p, const Eigen::Vector3f& n);

/// Angle by which a point already in the local frame must turn about x to reach the half-plane z = 0, y >= 0
/// (alpha_m and alpha_s of Equation 7), in (-pi, pi].
inline float alphaInLocalFrame(const Eigen::Vector3f& q) { return std::atan2(-q.z(), q.y()); }
}  // namespace bin_picking
