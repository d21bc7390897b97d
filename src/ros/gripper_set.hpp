// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "bin_picking_perception/grasping/gripper.hpp"

namespace bin_picking_ros
{
/// The grippers that may be on the arm, by the names in their files.
class GripperSet
{
public:
  /// \param resource file of the one that is meant where nobody says which \param others further files
  /// \throws bin_picking::Error a file is missing or wrong, or two grippers have one name
  static GripperSet load(const std::string& resource, std::vector<std::string> others);

  /// \pre not empty, names differ
  explicit GripperSet(std::vector<bin_picking::Gripper> grippers) : grippers_(std::move(grippers)) {}

  /// \param name empty: the first \throws RequestError(GRIPPER_UNKNOWN) with the nearest name
  const bin_picking::Gripper& find(const std::string& name) const;

  const std::vector<bin_picking::Gripper>& all() const { return grippers_; }

private:
  std::vector<bin_picking::Gripper> grippers_;
};
}  // namespace bin_picking_ros
