// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "sensor_parameters.hpp"

#include <cmath>

namespace bin_picking::simulation
{
namespace
{
constexpr double RIGHT_ANGLE = 1.5708;  // as it is written back from text

/// Active stereo at short range, 848 x 480, as the RealSense D435: docs/simulation.md.
SensorParameters stereoDefaults()
{
  SensorParameters p;
  p.type = SensorClass::Stereo;
  p.width = 848;
  p.height = 480;
  p.field_of_view = 1.576;
  p.second_field_of_view = p.field_of_view;
  p.baseline = 0.05;
  p.convergence = 0;
  p.reference_distance = 0.5;
  p.light.min_signal = 0.02;  // the cameras' own texture helps where the pattern fades
  p.noise.depth_noise = 0.0006;
  p.noise.correlation_length = 5;
  p.noise.white_share = 0;
  p.noise.bias = 0.0003;
  p.noise.bias_length = 40;
  p.noise.disparity_step = 1.0 / 32;
  p.noise.depth_step = 0.001;
  p.noise.drop_outs = 0.015;
  p.noise.drop_out_size = 4;
  p.edges.jump = 0.009;
  p.edges.loss_width = 2.3;
  p.edges.loss = 0.75;
  p.edges.loss_size = 6;
  p.edges.mixed_pixels = 0.2;
  p.edges.window = 9;
  p.edges.fattening = 0.4;
  return p;
}

SensorParameters idealDefaults()
{
  SensorParameters p;
  p.type = SensorClass::Ideal;
  p.baseline = 0;
  p.second_field_of_view = p.field_of_view;
  p.convergence = 0;
  p.light.albedo = 1;
  p.light.min_signal = 0;
  p.light.shininess = 0;
  p.light.max_incidence = RIGHT_ANGLE;
  p.light.loss_spread = 0;
  p.noise.depth_noise = 0;
  p.noise.bias = 0;
  p.noise.drop_outs = 0;
  p.edges.loss_width = 0;
  p.edges.loss = 0;
  p.edges.mixed_pixels = 0;
  return p;
}
}  // namespace

SensorParameters sensorDefaults(SensorClass type)
{
  switch (type)
  {
    case SensorClass::Stereo:
      return stereoDefaults();
    case SensorClass::Ideal:
      return idealDefaults();
    case SensorClass::StructuredLight:
      break;
  }
  return {};
}

PinholeCamera cameraOf(const SensorParameters& parameters)
{
  const double focal = 0.5 * parameters.width / std::tan(0.5 * parameters.field_of_view);
  return {focal, focal, 0.5 * (parameters.width - 1), 0.5 * (parameters.height - 1)};
}

void SensorParameters::visit(ParameterVisitor& v)
{
  const SensorClass before = type;
  v.field({"type", "", "kind of sensor; setting another sets all the others to that kind's defaults, so name it first"},
          type,
          {{"structured_light", SensorClass::StructuredLight},
           {"stereo", SensorClass::Stereo},
           {"ideal", SensorClass::Ideal}});
  if (type != before)
    *this = sensorDefaults(type);
  v.field({"width", "", "pixels per row", 16, 4096}, width);
  v.field({"height", "", "pixels per column", 16, 4096}, height);
  v.field({"field_of_view", "rad", "angle between the left and the right edge of the picture", 0.001, 2.5},
          field_of_view);
  v.field({"baseline", "m",
           "from the camera to the projector or second camera, along +x; more measures finer steps of disparity and "
           "throws longer shadows, 0: no second eye, every point that the camera sees is measured",
           0, 2},
          baseline);
  v.field(
      {"second_field_of_view", "rad", "the same of the second eye; what it does not cover is not measured", 0.001, 2.5},
      second_field_of_view);
  v.field({"convergence", "m",
           "distance at which the fields of the two eyes have the same middle; 0: their axes are parallel", 0, 100},
          convergence);
  v.field({"reference_distance", "m", "distance at which noise and signal are as given; noise grows with its square",
           0.05, 10},
          reference_distance);
  v.group("light", light);
  v.group("noise", noise);
  v.group("edges", edges);
}

void SensorLight::visit(ParameterVisitor& v)
{
  v.field({"albedo", "", "share of the light that the surfaces scatter; black rubber 0.04, white paper 0.9", 0.001, 1},
          albedo);
  v.field(
      {"min_signal", "",
       "less light than this is not measured, as a share of what a white surface returns that is lit frontally at the "
       "reference distance; larger loses dark, far and steep surfaces",
       0, 1},
      min_signal);
  v.field(
      {"shininess", "", "share of the pixels that a mirror reflection saturates in the middle of a highlight", 0, 1},
      shininess);
  v.field(
      {"highlight_width", "rad", "half width of a highlight, as an angle of the normal; polished is small", 0.001, 1},
      highlight_width);
  v.field(
      {"max_incidence", "rad", "surfaces that either eye sees flatter than this are not measured", 0.1, RIGHT_ANGLE},
      max_incidence);
  v.field({"loss_spread", "",
           "relative spread of both limits from pixel to pixel; larger frays the borders of what is lost", 0, 1},
          loss_spread);
}

void SensorNoise::visit(ParameterVisitor& v)
{
  v.field({"depth_noise", "m",
           "standard deviation of the depth at the reference distance and frontal incidence; grows with the square of "
           "the distance and with the incidence",
           0, 0.05},
          depth_noise);
  v.field({"correlation_length", "",
           "pixels after which the correlated part of the noise is alike by 1/e; larger makes it look like a surface",
           0.5, 50},
          correlation_length);
  v.field({"white_share", "", "share of the noise's variance that is independent from pixel to pixel", 0, 1},
          white_share);
  v.field(
      {"bias", "m",
       "standard deviation of the smooth error that the sensor repeats in every exposure, at the reference distance; "
       "bends flat surfaces",
       0, 0.05},
      bias);
  v.field({"bias_length", "", "pixels after which the smooth error is alike by 1/e", 4, 1000}, bias_length);
  v.field({"disparity_step", "", "smallest step of disparity, pixels; larger makes terraces, 0: none", 0, 2},
          disparity_step);
  v.field({"depth_step", "m", "unit in which depths are reported; 0: exact", 0, 0.01}, depth_step);
  v.field({"drop_outs", "", "share of the pixels that are lost without cause", 0, 0.5}, drop_outs);
  v.field({"drop_out_size", "", "diameter of such a hole, pixels", 1, 20}, drop_out_size);
}

void SensorEdges::visit(ParameterVisitor& v)
{
  v.field({"jump", "m", "difference of depth between neighbouring pixels, beyond the surface's slope, that is an edge",
           0.0001, 0.1},
          jump);
  v.field({"loss_width", "", "pixels on either side of an edge among which some are lost", 0, 10}, loss_width);
  v.field({"loss", "", "share of those pixels that is lost", 0, 1}, loss);
  v.field({"loss_size", "", "pixels across a patch that is lost as one; 1: every pixel for itself", 1, 20}, loss_size);
  v.field(
      {"mixed_pixels", "",
       "share of the pixels at an edge that report a depth between the two surfaces; with a window, the share of it "
       "across which the depth passes from one to the other",
       0, 1},
      mixed_pixels);
  v.field({"window", "",
           "side of the square of pixels that is matched as one, odd; larger rounds off small shapes, 1: none", 1, 31},
          window);
  v.field({"fattening", "",
           "share of the window that the nearer surface must fill to win it; less than a half makes parts fatter", 0.05,
           0.95},
          fattening);
}
}  // namespace bin_picking::simulation
