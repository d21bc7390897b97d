// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/grasp_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "bin_picking_perception/common/figures.hpp"

namespace bin_picking
{
namespace
{
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();
using Fault = GraspCheck::Fault;

std::string list(const Eigen::Vector3d& v)
{
  const auto text = [](double value) { return roundedText(std::abs(value) < 5e-5 ? 0.0 : value, 4); };  // never -0
  return "[" + text(v.x()) + ", " + text(v.y()) + ", " + text(v.z()) + "]";
}

/// What the gripper cannot do, whatever the part.
std::optional<GraspCheck::Finding> openingFault(const GraspDefinition& grasp, const Gripper& gripper)
{
  const std::string name = "the '" + gripper.name + "'";
  if (grasp.opening == 0)
    return GraspCheck::Finding{Fault::Opening, "it is one for a suction cup (its opening is 0), " + name +
                                                   " has fingers; write the opening that these have on the way in"};
  if (grasp.opening > gripper.max_opening)
  {
    const auto [opening, most] = toldApart(grasp.opening, gripper.max_opening, millimetres);
    return GraspCheck::Finding{Fault::Opening, "it asks for an opening of " + opening + ", " + name + " opens to " +
                                                   most +
                                                   "; write a smaller opening, or grasp where the part is narrower"};
  }
  if (grasp.width < gripper.min_opening)
  {
    const auto [width, least] = toldApart(grasp.width, gripper.min_opening, millimetres);
    return GraspCheck::Finding{Fault::Opening, "it holds at a width of " + width + ", " + name + " closes to " + least +
                                                   "; grasp where the part is wider"};
  }
  return std::nullopt;
}

std::string squareMillimetres(double square_metres, int digits)
{
  return roundedText(1e6 * square_metres, digits) + " mm^2";
}

void judgeContact(const PadContact& contact, const char* pad, const GraspCheckParameters& parameters,
                  GraspCheck& result)
{
  if (contact.area >= parameters.min_contact_area)
    return;
  const auto [area, least] = toldApart(contact.area, parameters.min_contact_area, squareMillimetres, 0);
  result.findings.push_back(
      {Fault::Contact, "the pad at " + std::string(pad) + " closing holds " + area +
                           " of surface that is inclined by no more than the " +
                           degrees(std::atan(parameters.friction)) + " of friction (mean " + degrees(contact.angle) +
                           "), at least " + least +
                           " are required; move the grasp to where the surface lies flat on the pad"});
}

/// What the position and the width should be instead.
void judgeWidth(const GraspDefinition& grasp, const Pose& T_object_tip, const GraspCheckParameters& parameters,
                GraspCheck& result)
{
  if (std::abs(result.width - grasp.width) > parameters.max_width_error)
  {
    const auto [measured, stated] = toldApart(result.width, grasp.width, millimetres);
    result.findings.push_back({Fault::Width, "the part is " + measured + " wide between the pads, not " + stated +
                                                 "; write width: " + roundedText(result.width, 4)});
  }
  if (std::abs(result.offset) > parameters.max_offset)
  {
    const Eigen::Vector3d middle = T_object_tip.translation() + result.offset * T_object_tip.linear().col(1);
    result.findings.push_back(
        {Fault::OffCentre, "the part's middle lies " + millimetres(std::abs(result.offset)) + " off, towards " +
                               (result.offset > 0 ? "+" : "-") +
                               "closing, and the first finger would push it; write position: " + list(middle)});
  }
}
}  // namespace

void GraspCheckParameters::visit(ParameterVisitor& v)
{
  v.field({"max_width_error", "m", "largest difference of the part between the pads from the stated width", 0, 0.02},
          max_width_error);
  v.field({"max_offset", "m", "largest distance of the part's middle from the tip along the closing axis", 0, 0.02},
          max_offset);
  v.field({"friction", "", "coefficient between pad and part: surface that is inclined more is not held", 0.01, 2},
          friction);
  v.field({"compliance", "m", "what the pads give way: surface within it of the first contact is touched", 1e-5, 0.005},
          compliance);
  v.field({"min_contact_area", "m^2", "smallest surface that each pad has to hold", 0, 0.01}, min_contact_area);
  v.field({"min_clearance", "m", "smallest distance of the open gripper from the part on the way in", 0, 0.02},
          min_clearance);
  v.field({"resolution", "m", "distance of the rays between the pads; smaller takes longer", 1e-4, 0.005}, resolution);
  v.field({"surface_spacing", "m",
           "distance of the points of the part that must miss the gripper; smaller finds thinner spikes, takes longer",
           1e-4, 0.01},
          surface_spacing);
}

const char* toString(Fault fault)
{
  switch (fault)
  {
    case Fault::Opening:
      return "opening";
    case Fault::Nothing:
      return "nothing between";
    case Fault::Width:
      return "width";
    case Fault::OffCentre:
      return "off centre";
    case Fault::Contact:
      return "contact";
    case Fault::WayIn:
      return "way in";
    case Fault::Closing:
      return "closing";
  }
  return "unknown";
}

GraspCheck GraspChecker::check(const GraspDefinition& grasp, const Pose& T_object_tip) const
{
  GraspCheck result;
  result.width = result.offset = result.clearance = NaN;
  if (const auto fault = openingFault(grasp, gripper_))
  {
    result.findings.push_back(*fault);
    return result;
  }
  measure(T_object_tip, grasp.width, grasp.opening / 2, result);
  if (std::isnan(result.width))
    result.findings.push_back({Fault::Nothing, "a pad meets no surface of the part when the fingers close from " +
                                                   millimetres(grasp.opening) +
                                                   "; check position, approach and closing (frame of the "
                                                   "mesh, metres), and that the opening is wider than the part"});
  else
  {
    judgeWidth(grasp, T_object_tip, parameters_, result);
    judgeContact(result.right, "+", parameters_, result);
    judgeContact(result.left, "-", parameters_, result);
  }
  approach(grasp, T_object_tip, result);
  if (result.clearance < parameters_.min_clearance)
    result.findings.push_back(wayInFinding(grasp, T_object_tip, result));
  std::string body;
  if (result.good())  // else the fingers close elsewhere
    if (const double depth = closing(grasp, T_object_tip, result.offset, body); depth < 0)
      result.findings.push_back({Fault::Closing, "the " + body + " would cut " + millimetres(-depth) +
                                                     " into the part while the fingers close; move the grasp away from "
                                                     "what stands beside it, or approach from another side"});
  return result;
}

GraspCheck::Finding GraspChecker::wayInFinding(const GraspDefinition& grasp, const Pose& T_object_tip,
                                               const GraspCheck& result) const
{
  const auto fits = [&](const GraspDefinition& changed, const Pose& T) {
    GraspCheck other;
    approach(changed, T, other);
    return other.clearance >= parameters_.min_clearance;
  };
  constexpr double STEP = 0.001, FARTHEST = 0.03;
  std::string cure;
  for (GraspDefinition wider = grasp; cure.empty() && (wider.opening += STEP) <= gripper_.max_opening;)
    if (fits(wider, T_object_tip))
      cure = "write opening: " + roundedText(wider.opening, 3);
  for (double back = STEP; cure.empty() && back <= FARTHEST; back += STEP)
  {
    const Pose moved = T_object_tip * Eigen::Translation3d(0, 0, -back);
    if (fits(grasp, moved))
      cure = "grasp less deep, write position: " + list(moved.translation()) + " (and check what is between the pads)";
  }
  if (cure.empty())
    cure = "no opening up to " + millimetres(gripper_.max_opening) + " is free: approach from another side";
  const auto [figure, least] = toldApart(result.clearance, parameters_.min_clearance, millimetres);
  const std::string passage = result.clearance < 0 ? " would cut " + figure + " into the part at "
                                                   : " would pass at " + figure + " from the part at ";
  return {Fault::WayIn, "on the way in, open to " + millimetres(grasp.opening) + ", the " + result.closest + passage +
                            list(result.closest_at) + " m, at least " + least + " are required; " + cure};
}

GraspCheck GraspChecker::check(const GraspDefinition& grasp) const
{
  GraspCheck result = check(grasp, grasp.T_object_tip);
  if (!result.good())
    return result;
  for (const GraspVariant& variant : expandTolerances(grasp))
  {
    const GraspCheck turned = check(grasp, variant.T_object_tip);
    if (turned.clearance < result.clearance)
    {
      result.clearance = turned.clearance;
      result.closest = turned.closest;
      result.closest_at = turned.closest_at;
    }
    if (turned.good())
      continue;
    result.findings.push_back(
        {turned.findings.front().fault, "at a tilt of " + degrees(variant.tilt) + " and a spin of " +
                                            degrees(variant.spin) + ", which the tolerances allow, " +
                                            turned.findings.front().sentence + ", or allow less tolerance"});
    break;
  }
  return result;
}
}  // namespace bin_picking
