// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/evaluation/scene_judgement.hpp"
#include "core/mesh_shapes.hpp"

namespace bin_picking
{
namespace test
{
/// A bar of 80 x 40 x 20 mm that equals itself after a half turn about z; diameter sqrt(80^2 + 40^2 + 20^2) = 91.65 mm,
/// so that poses are right below 9.165 mm.
inline PartShapes barShapes()
{
  Symmetry symmetry;
  symmetry.discrete.emplace_back(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()));
  return {{"bar", makePartShape(box(0.08f, 0.04f, 0.02f), symmetry)},
          {"cube", makePartShape(box(0.05f, 0.05f, 0.05f), {})}};
}

inline Pose poseAt(double x, double y)
{
  return Eigen::Translation3d(x, y, 0.8) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
}

inline TrueInstance instanceOf(const std::string& part, const Pose& T, double visible_fraction = 1)
{
  TrueInstance instance;
  instance.part = part;
  instance.T_camera_object = T;
  instance.visible_fraction = visible_fraction;
  return instance;
}

/// Bars side by side, 0.2 m apart, with these visible fractions.
inline EvaluationScene sceneOfBars(const std::vector<double>& visible_fractions)
{
  EvaluationScene scene;
  scene.name = "scene";
  scene.parts = {"bar"};
  for (const double visible : visible_fractions)
    scene.instances.push_back(instanceOf("bar", poseAt(0.2 * static_cast<double>(scene.instances.size()), 0), visible));
  return scene;
}

/// The k-th bar of sceneOfBars, moved by so much along the camera's x.
inline PoseEstimate bar(std::size_t k, double score, double shift = 0)
{
  return {"bar", Eigen::Translation3d(shift, 0, 0) * poseAt(0.2 * static_cast<double>(k), 0), score};
}
}  // namespace test
}  // namespace bin_picking
