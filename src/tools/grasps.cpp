// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iomanip>
#include <iostream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/figures.hpp"
#include "bin_picking_perception/evaluation/grasp_picture.hpp"
#include "bin_picking_perception/grasping/grasp_check.hpp"
#include "bin_picking_perception/grasping/grasp_proposal.hpp"
#include "commands.hpp"
#include "detector_options.hpp"
#include "terminal.hpp"

namespace bin_picking::tools
{
namespace
{
namespace fs = std::filesystem;

constexpr int CONTINUOUS_STEPS = 12;
constexpr double UPRIGHT_TILT = M_PI / 4;  // rad, of the coverage that is told

/// What the command works on.
struct Task
{
  PartDefinition part;
  TriangleMesh mesh;
  Gripper gripper;
  GraspCheckParameters parameters;
};

/// The gripper that was given, or the AG-95 of the same configuration as the part: its folder beside that of the parts.
Gripper gripperFrom(const Arguments& arguments, const PartDefinition& part)
{
  if (arguments.has("--gripper"))
    return loadGripper(arguments.value("--gripper"));
  const fs::path beside = fs::absolute(part.directory).lexically_normal() / "../../grippers/ag95.yaml";
  if (!fs::exists(beside))
    throw UsageError("there is no gripper file beside the parts ('" + beside.lexically_normal().string() +
                     "'); name yours with --gripper");
  return loadGripper(beside.lexically_normal().string());
}

Task taskFrom(const Arguments& arguments)
{
  Task task;
  task.part = loadPart(arguments.positional(0));
  if (isPointModel(task.part.mesh_file))
    throw FileError("'" + task.part.mesh_file +
                    "' has points but no faces, and grasps can only be held against faces; "
                    "use a mesh");
  task.mesh = loadMesh(task.part.mesh_file, task.part.mesh_unit);
  checkExpectedSize(task.part, inspectMesh(task.mesh).size);
  task.gripper = gripperFrom(arguments, task.part);
  applyAssignments(arguments, visitor(task.parameters));
  return task;
}

std::string millimetres(double value) { return std::isnan(value) ? "-" : roundedText(1e3 * value, 1); }

void printTable(const std::vector<DrawnGrasp>& grasps)
{
  std::size_t longest = 5;
  for (const DrawnGrasp& drawn : grasps)
    longest = std::max(longest, drawn.grasp.id.size());
  const auto row = [&](const std::string& id, const std::vector<std::string>& cells, const std::string& verdict) {
    std::cout << std::left << std::setw(static_cast<int>(longest) + 2) << id << std::right;
    for (const std::string& cell : cells)
      std::cout << std::setw(11) << cell;
    std::cout << "  " << verdict << "\n";
  };
  row("grasp", {"width", "measured", "off centre", "contact +", "contact -", "way in"}, "verdict");
  row("", {"mm", "mm", "mm", "mm^2", "mm^2", "mm"}, "");
  for (const DrawnGrasp& drawn : grasps)
  {
    const GraspCheck& check = drawn.check;
    std::string verdict;
    for (const auto& finding : check.findings)
      verdict += (verdict.empty() ? "" : ", ") + std::string(toString(finding.fault));
    row(drawn.grasp.id,
        {millimetres(drawn.grasp.width), millimetres(check.width), millimetres(check.offset),
         roundedText(1e6 * check.right.area, 0), roundedText(1e6 * check.left.area, 0), millimetres(check.clearance)},
        verdict.empty() ? "holds" : verdict);
  }
}

void printFindings(const std::vector<DrawnGrasp>& grasps)
{
  for (const DrawnGrasp& drawn : grasps)
    for (const auto& finding : drawn.check.findings)
      std::cout << "\n" << drawn.grasp.id << ": " << finding.sentence << ".\n";
}

void printCoverage(PartDefinition part, const std::vector<DrawnGrasp>& grasps)
{
  part.grasps.clear();
  for (const DrawnGrasp& drawn : grasps)
    if (drawn.check.good())
      part.grasps.push_back(drawn.grasp);
  const auto variants = expandGrasps(part, CONTINUOUS_STEPS);
  std::cout << "\n"
            << part.grasps.size() << " good grasps, " << variants.size() << " with symmetry and tolerances; they take "
            << roundedText(100 * attitudeCoverage(variants, UPRIGHT_TILT), 0)
            << " % of all attitudes of the part with an approach of at most 45 deg from straight down.\n";
}

std::vector<DrawnGrasp> checkAll(const Task& task, const std::vector<GraspDefinition>& grasps)
{
  const GraspChecker checker(task.mesh, task.gripper, task.parameters);
  std::vector<DrawnGrasp> drawn;
  for (const GraspDefinition& grasp : grasps)
    drawn.push_back({grasp, checker.check(grasp)});
  return drawn;
}

void propose(const Task& task, const Arguments& arguments)
{
  const int count = parseInteger(arguments.value("--propose"), "--propose", 1, 1000);
  const Executor executor(parseInteger(arguments.value("--threads", "0"), "--threads", 0, 1024));
  Progress progress;
  progress.show("looking for opposed faces");
  const auto grasps = proposeGrasps(task.part, task.mesh, task.gripper, task.parameters, count, executor);
  progress.finish();
  if (grasps.empty())
    throw Error("no two opposed faces of '" + task.part.name + "' can be held by the '" + task.gripper.name +
                "'; is the unit of the mesh right, and the gripper wide enough?");
  std::cout << graspsToYaml(grasps);
  if (arguments.has("--image"))
    saveGraspPicture(task.mesh, task.gripper, checkAll(task, grasps), arguments.value("--image"));
}

void check(const Task& task, const Arguments& arguments)
{
  if (task.part.grasps.empty())
    throw Error("the part.yaml of '" + task.part.name + "' has no grasps; '--propose 10' suggests some");
  const std::vector<DrawnGrasp> grasps = checkAll(task, task.part.grasps);
  std::cout << task.part.name << " with " << task.gripper.name << "\n";
  printTable(grasps);
  printFindings(grasps);
  printCoverage(task.part, grasps);
  if (arguments.has("--image"))
    saveGraspPicture(task.mesh, task.gripper, grasps, arguments.value("--image"));
  const auto bad = std::count_if(grasps.begin(), grasps.end(), [](const DrawnGrasp& d) { return !d.check.good(); });
  if (bad > 0)
    throw Error(std::to_string(bad) + " of the " + std::to_string(grasps.size()) + " grasps of '" + task.part.name +
                "' would fail; see above for the cure of each");
}

void grasps(const Arguments& arguments)
{
  const Task task = taskFrom(arguments);
  if (arguments.has("--propose"))
    propose(task, arguments);
  else
    check(task, arguments);
}
}  // namespace

Command graspsCommand()
{
  return {{"grasps",
           "Holds the grasps of a part against its mesh and a gripper, and says what is wrong (exit code 1) and what "
           "would cure it; or proposes grasps.",
           {"PART_DIR"},
           {{"--gripper", "FILE.yaml", Values::One, "the gripper (default: ../../grippers/ag95.yaml from the part)"},
            {"--propose", "N", Values::One,
             "instead write at most N grasps between opposed faces of the mesh, as the grasps: of a part.yaml"},
            {"--image", "FILE.png", Values::One, "draw the part with the gripper, a tile per grasp"},
            {"--set", "KEY=VALUE", Values::Assignments,
             "what is allowed, e.g. friction=0.3 ('bin_picking parameters --of grasps' lists them)"},
            {"--threads", "N", Values::One, "threads to use for proposals; 0: all processors (default)"}},
           "grasps config/parts/three_way_tube --image grasps.png"},
          grasps};
}
}  // namespace bin_picking::tools
