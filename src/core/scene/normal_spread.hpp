// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>

#include "neighbourhood.hpp"

namespace bin_picking
{
/// Variance of the normals around a point, projected onto its tangent plane.
class NormalSpread
{
public:
  /// \param normal of the point
  explicit NormalSpread(const Eigen::Vector3f& normal) : normal_(normal) {}

  /// Those that are turned from the point's by no more than min_cosine says.
  void add(const Neighbourhood& found, float min_cosine)
  {
    for (std::size_t k = 0; k < found.size; ++k)
    {
      const Eigen::Vector3f n(found.nx[k], found.ny[k], found.nz[k]);
      if (!(n.dot(normal_) >= min_cosine))
        continue;
      const Eigen::Vector3d projected = (n - normal_.dot(n) * normal_).cast<double>();
      total_ += projected;
      squares_ += projected.squaredNorm();
      count_ += 1;
    }
  }

  double count() const { return count_; }
  /// (pc1 + pc2) / 2: half the trace of the covariance. \pre count() > 0
  double variation() const { return (squares_ / count_ - (total_ / count_).squaredNorm()) / 2; }

private:
  Eigen::Vector3f normal_;
  Eigen::Vector3d total_ = Eigen::Vector3d::Zero();
  double squares_ = 0;
  double count_ = 0;
};
}  // namespace bin_picking
