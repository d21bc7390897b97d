// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking::simulation
{
enum class SensorClass
{
  StructuredLight,  ///< camera and projector, as PhoXi, Zivid, COMATRIX
  Stereo,           ///< two cameras and a pattern, as RealSense
  Ideal             ///< every visible point, exactly
};

/// How much light comes back, and where it is too little or too much.
struct SensorLight
{
  double albedo = 0.5;
  double min_signal = 0.06;
  double shininess = 0.2;
  double highlight_width = 0.1;
  double max_incidence = 1.4;
  double loss_spread = 0.35;

  void visit(ParameterVisitor& v);
};

/// What is wrong with a depth far from any edge.
struct SensorNoise
{
  double depth_noise = 0.00019;
  double correlation_length = 12;
  double white_share = 0.13;
  double bias = 0.00015;
  double bias_length = 36;
  double disparity_step = 0;
  double depth_step = 0;
  double drop_outs = 0.0005;
  double drop_out_size = 1;

  void visit(ParameterVisitor& v);
};

/// What goes wrong where the depth jumps, and how far a sensor that compares windows of pixels blurs it.
struct SensorEdges
{
  double jump = 0.003;
  double loss_width = 1.5;
  double loss = 0.3;
  double loss_size = 1;
  double mixed_pixels = 0.005;
  int window = 1;
  double fattening = 0.5;

  void visit(ParameterVisitor& v);
};

/// A 3D sensor. The defaults in the class are those of structured light; docs/simulation.md tells where they come from.
struct SensorParameters
{
  SensorClass type = SensorClass::StructuredLight;
  int width = 1280;
  int height = 1024;
  double field_of_view = 0.735;
  double baseline = 0.2;
  double second_field_of_view = 0.829;
  double convergence = 0.8;
  double reference_distance = 0.8;
  SensorLight light;
  SensorNoise noise;
  SensorEdges edges;

  /// Setting `type` to another class sets every other field to that class's defaults: name it first.
  void visit(ParameterVisitor& v);
};

/// The defaults of a class of sensors.
SensorParameters sensorDefaults(SensorClass type);

/// The camera that the parameters describe: square pixels, its axis through the middle of the picture.
PinholeCamera cameraOf(const SensorParameters& parameters);
}  // namespace bin_picking::simulation
