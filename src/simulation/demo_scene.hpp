// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "bin_picking_perception/scene/bin.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"
#include "pile.hpp"
#include "structured_light.hpp"

namespace bin_picking::simulation
{
struct DemoSceneParameters
{
  PileParameters pile;
  SensorParameters sensor;

  void visit(ParameterVisitor& v);
};

/// Where a part truly lies, and how much of it the camera could see.
struct DemoInstance
{
  Pose T_camera_object = Pose::Identity();
  int visible_pixels = 0;
  double visible_fraction = 0;  ///< visible pixels / pixels if nothing else were there, [0, 1]
};

struct DemoScene
{
  DepthGrid grid;
  Bin bin;
  std::vector<DemoInstance> instances;  ///< in the order of placing
  std::vector<std::int32_t> labels;     ///< per pixel: index into instances; -1: bin or nothing
};

/// A filled bin under a structured-light camera. The same parameters give the same bits.
/// \throws ParameterError a parameter is out of range; the part does not fit; the pile is higher than the bin
DemoScene makeDemoScene(const TriangleMesh& part, const DemoSceneParameters& parameters);
}  // namespace bin_picking::simulation
