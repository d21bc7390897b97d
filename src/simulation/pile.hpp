// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking::simulation
{
/// How a heap of parts is laid without physics: each part is lowered straight down until it first touches what lies
/// below. Of many random places and attitudes the one with the lowest centre of mass is taken and then shaken further
/// down, so that parts come to lie much as dropped ones do.
struct PileParameters
{
  int count = 25;
  int seed = 1;
  double bin_length = 0.4;
  double bin_width = 0.3;
  double bin_height = 0.15;
  int attempts = 24;
  int shakes = 120;

  void visit(ParameterVisitor& v);
};

/// T_bin_object of each part, in the order of placing. Frame of the bin: origin in the middle of the inner floor, z up.
/// \throws ParameterError the part does not fit into the bin; so many parts that they heap over the rim
std::vector<Pose> layPile(const TriangleMesh& part, const PileParameters& parameters);

/// Centre of the enclosed volume; of the surface if the mesh encloses none.
Eigen::Vector3d centerOfMass(const TriangleMesh& mesh);
}  // namespace bin_picking::simulation
