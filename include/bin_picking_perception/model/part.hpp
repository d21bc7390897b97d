// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking
{
/// Rotations that map a part onto itself, in the part frame.
struct Symmetry
{
  /// Finite group, the identity included and first: closed under composition.
  std::vector<Pose> discrete = {Pose::Identity()};

  struct Axis
  {
    Eigen::Vector3d direction;  ///< unit
    Eigen::Vector3d origin;     ///< a point on the axis, metres
  };
  /// Axis of revolution, if the part has one; `discrete` then holds the flips that remain.
  std::optional<Axis> continuous;

  bool trivial() const { return discrete.size() == 1 && !continuous; }

  /// All symmetric rotations, the identity first, the continuous axis sampled at `steps` angles.
  /// \throws ParameterError steps < 1
  std::vector<Pose> sampled(int steps) const;
};

/// The finite group that the rotations generate, the identity first. Elements closer than 0.1 degrees and 1 um are one.
/// \throws ParameterError more than 120 elements (no finite rotation group of a part is larger; an axis or order is
/// wrong)
std::vector<Pose> closeUnderComposition(const std::vector<Pose>& generators);

/// The representative of T's symmetry class that is nearest in rotation to `reference`.
Pose nearestEquivalent(const Pose& T_camera_object, const Pose& reference, const Symmetry& symmetry);

/// The turn about an axis by an angle (rad), as a motion of the part's frame.
Pose rotationAbout(const Symmetry::Axis& axis, double angle);

/// One way to take the part, as a person wrote it down.
struct GraspDefinition
{
  std::string id;
  std::string copy_of;  ///< id of the grasp that this one repeats elsewhere around an axis; empty: none
  /// Frame between the finger tips: Z = approach, Y = finger closing direction.
  Pose T_object_tip = Pose::Identity();
  double width = 0;        ///< finger distance when holding, metres
  double opening = 0;      ///< finger distance on the way in, metres
  double approach = 0.08;  ///< distance of the pre-grasp back along Z, metres
  double retreat = 0.10;   ///< distance of the retreat, metres (against gravity where known, else back along Z)
  int priority = 0;        ///< larger is preferred
  bool symmetric = true;   ///< also offer the copies under the part's symmetry
  /// How far the gripper may be tilted about its closing axis Y and turned about its approach axis Z, to either side,
  /// through the point between the finger tips. Radians; 0: not at all. See expandGrasps.
  double tilt_tolerance = 0;
  double spin_tolerance = 0;
};

/// What part.yaml says. The mesh path is absolute or relative to the working folder after loading.
struct PartDefinition
{
  std::string name;
  std::string directory;
  std::string mesh_file;
  LengthUnit mesh_unit = LengthUnit::Metre;
  std::optional<Eigen::Vector3d> expected_size;  ///< bounding box that the mesh must have (1 % or 0.5 mm), metres
  Symmetry symmetry;
  bool symmetry_stated = false;  ///< `symmetry` holds even if it is trivial; otherwise training looks for one
  std::vector<GraspDefinition> grasps;
  std::string training_yaml;       ///< the `training:` map as text, to be applied over the preset; may be empty
  std::vector<std::string> files;  ///< all that make up the part: its part.yaml first, then those that it names
};

/// Reads DIRECTORY/part.yaml (or a part.yaml given by name).
/// \throws FileError missing file; unknown key (with "did you mean"); no unit; a mistyped number; a grasp without id;
/// ...
///   with the line
PartDefinition loadPart(const std::string& path);

/// \param size bounding box of the part's mesh, metres
/// \throws FileError it is not the expected_size of part.yaml (1 % or 0.5 mm): the mesh or its unit is a wrong one
void checkExpectedSize(const PartDefinition& definition, const Eigen::Vector3d& size);
}  // namespace bin_picking
