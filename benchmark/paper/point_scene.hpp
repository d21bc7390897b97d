// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "bin_picking_perception/model/part.hpp"
#include "method.hpp"

namespace bin_picking::paper
{
/// An object of the public sets or of the user: its surface as oriented points, at its size.
struct PointObject
{
  PartDefinition part;     ///< to train from
  OrientedPoints surface;  ///< dense, part frame, metres
  double resolution = 0;   ///< mean distance of a point to its nearest neighbour, metres: the "mesh resolution"
};

/// {"name", "file", "unit"} and, for models of any scale, "diagonal": that of the bounding box, metres; or {"part":
/// folder}. A scaled copy to train from goes into `folder`. \throws FileError
PointObject readObject(const Json& json, const std::string& folder);

enum class SceneKind
{
  Whole,   ///< all of the surface, as in the paper's Tables 1-4
  View,    ///< what a camera sees of it
  Clutter  ///< what a camera sees of it among others that hide it
};
SceneKind parseSceneKind(const std::string& name);

/// Points of one exposure and where the object is in them.
struct PointScene
{
  OrientedPoints points;
  std::vector<Eigen::Vector3f> of_object;  ///< those of the object
  Pose T_camera_object = Pose::Identity();
  double seen_share = 0;     ///< of all surface points of the object; 1 - occlusion (Mian et al. 2006)
  double visible_share = 0;  ///< of those that would be seen were it alone
};

/// The same seed and trial give the same motions for every kind and noise.
/// \param objects the first is searched for, the others are clutter. \param noise in units of its resolution
PointScene makePointScene(const std::vector<PointObject>& objects, SceneKind kind, double noise, std::uint32_t seed);

/// A scan from a file with the pose of the object: {"file", "unit", "truth": 4x4 matrix as text, millimetres}.
PointScene readPointScene(const Json& json, const PointObject& object);
}  // namespace bin_picking::paper
