// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/grasping/grasp_expansion.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
class SurfaceBlocks;

/// When a grasp that was written down fits its part.
struct GraspCheckParameters
{
  double max_width_error = 0.001;
  double max_offset = 0.001;
  double friction = 0.4;
  double compliance = 0.0003;
  double min_contact_area = 12e-6;
  double min_clearance = 0.001;
  double resolution = 0.0005;
  double surface_spacing = 0.0007;

  void visit(ParameterVisitor& v);
};

/// What lies under one pad when the fingers close.
struct PadContact
{
  double position = 0;  ///< of the surface that the pad meets first, along the closing axis Y of the tip, metres
  double area = 0;      ///< within the compliance of it and inclined no more than friction holds, square metres
  double angle = 0;     ///< between the mean normal of what lies within the compliance and the closing axis, rad
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< of it, tip frame, metres
};

/// A grasp held against the part's mesh. NaN where it cannot be told.
struct GraspCheck
{
  enum class Fault
  {
    Opening,    ///< the gripper does not open as far, or not close as far, as the grasp asks
    Nothing,    ///< no surface between the pads
    Width,      ///< the part is wider or narrower there than stated
    OffCentre,  ///< one finger would push the part before the other meets it
    Contact,    ///< too little surface under a pad, or too inclined for friction to hold
    WayIn,      ///< the open gripper runs into the part, or passes too close
    Closing     ///< something other than the pads meets the part while the fingers close
  };
  struct Finding
  {
    Fault fault;
    std::string sentence;  ///< what, with numbers, and what would cure it
  };

  double width = 0;      ///< of the part between the pads, metres
  double offset = 0;     ///< of the part's middle from the tip, along the closing axis, metres
  PadContact right;      ///< of the pad at +Y
  PadContact left;       ///< of the pad at -Y
  double clearance = 0;  ///< of the open gripper on the way in, metres; negative: how deep it would cut. The smallest
                         ///< of all turns that were looked at, and so are the next two
  std::string closest;   ///< the gripper's body that is there
  Eigen::Vector3d closest_at = Eigen::Vector3d::Zero();  ///< where, in the part's frame, metres
  std::vector<Finding> findings;                         ///< empty: the grasp holds

  bool good() const { return findings.empty(); }
};

const char* toString(GraspCheck::Fault fault);

/// Holds grasps of one part against its mesh with one gripper. Immutable; safe to share between threads.
///
/// Width and contact come from rays along the closing axis, `resolution` apart, through all that both pads cover: the
/// triangles that they meet are exact, so that a flat face is measured to rounding. The ways in and of closing are
/// looked at with points of the surface (vertices, and samples `surface_spacing` apart) against all that the convex
/// pieces of the gripper sweep; a spike thinner than the spacing may be missed. The pads close to 1 mm from the stated
/// width on either side, the other bodies all the way.
class GraspChecker
{
public:
  /// \param mesh closed, outward; both must outlive the checker
  /// \throws ParameterError a parameter out of its range; an empty mesh; a gripper without a pad (body with
  /// touches_part) on either side of its tip
  GraspChecker(const TriangleMesh& mesh, const Gripper& gripper, const GraspCheckParameters& parameters = {});

  // All throw ParameterError for a width that the gripper does not open to, measure() and approach() also for an
  // opening or a width that check() tells as a finding.

  /// The grasp with the tip at a pose; width, opening and approach are those of the definition.
  GraspCheck check(const GraspDefinition& grasp, const Pose& T_object_tip) const;

  /// As written; of the tolerances, what fails at the smallest turn is added, with the turn.
  GraspCheck check(const GraspDefinition& grasp) const;

  /// Width, offset and contacts alone. \param reach half of the space between the pads that is looked at, metres
  void measure(const Pose& T_object_tip, double width, double reach, GraspCheck& result) const;

  /// Smallest signed distance of the part's surface from the open gripper on its straight way in (metres), with body
  /// and place.
  void approach(const GraspDefinition& grasp, const Pose& T_object_tip, GraspCheck& result) const;

private:
  double closing(const GraspDefinition& grasp, const Pose& T_object_tip, double offset, std::string& body) const;
  GraspCheck::Finding wayInFinding(const GraspDefinition& grasp, const Pose& T_object_tip,
                                   const GraspCheck& result) const;

  const TriangleMesh& mesh_;
  const Gripper& gripper_;
  GraspCheckParameters parameters_;
  std::shared_ptr<const SurfaceBlocks> surface_;
};
}  // namespace bin_picking
