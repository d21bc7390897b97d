// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "grip_scene.hpp"

namespace bin_picking::simulation
{
/// Where fingers of one side touch a part: all of its surface that the pads reach when they press in by
/// GripTrialParameters::contact_depth, which real pads and parts that turn into the grip do.
struct ContactPatch
{
  double area = 0;         ///< square metres
  double inside_cone = 0;  ///< of that: where the normal lies within the friction cone of the finger's force
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();  ///< area times middle, bin frame

  Eigen::Vector3d middle() const { return moment / area; }
};

/// \param pad where it just touches \param outwards unit, from the part to the finger, bin frame
void addContact(ContactPatch& patch, const PlacedMesh& target, const ConvexBody& pad_bin,
                const Eigen::Vector3d& outwards_bin, const GripTrialParameters& parameters);

/// Whether two fingers hold between them. \return empty, or why they do not \param closing unit, to the right finger
std::string judgeContacts(const ContactPatch& right, const ContactPatch& left, const PlacedMesh& target,
                          const Eigen::Vector3d& closing_bin, const GripTrialParameters& parameters);

/// The body moved, not turned.
ConvexBody moved(ConvexBody body, const Eigen::Vector3d& motion);
}  // namespace bin_picking::simulation
