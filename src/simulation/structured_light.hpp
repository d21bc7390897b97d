// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking::simulation
{
/// A structured-light camera: a pinhole camera and a projector beside it. What the projector does not reach is not
/// measured.
struct SensorParameters
{
  int width = 1280;
  int height = 1024;
  double distance = 0.8;
  double tilt = 0.14;
  double field_of_view = 0.735;
  double baseline = 0.2;
  double depth_noise = 0.0001;
  double max_incidence = 1.3613568;  // 78 degrees
  int seed = 1;

  void visit(ParameterVisitor& v);
};

PinholeCamera cameraOf(const SensorParameters& parameters);

/// The projector as a camera that sees at least what the camera sees at the nominal distance.
DepthRenderer makeProjector(const SensorParameters& parameters);
/// Its optical frame: the camera's, moved by the baseline along x.
Pose projectorFromCamera(const SensorParameters& parameters);

/// What the sensor measures of an ideal view: nothing at grazing incidence, at lone pixels and in the projector's
/// shadow, else the depth with noise that is correlated between neighbouring pixels and grows with the square of the
/// distance and with the incidence. \param projector the same scene drawn from projectorFromCamera()
DepthGrid measure(const DepthRenderer& view, const DepthRenderer& projector, const SensorParameters& parameters);
}  // namespace bin_picking::simulation
