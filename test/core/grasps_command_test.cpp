// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// Runs "bin_picking grasps" as a user does: exit codes, what is said, and that proposals can be pasted.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/command_runner.hpp"

namespace bin_picking
{
namespace
{
namespace fs = std::filesystem;
using namespace test;

const std::string CONFIG = std::string(BIN_PICKING_SOURCE_DIR) + "/config";
const std::string TUBE = CONFIG + "/parts/three_way_tube";
const std::string AG95 = " --gripper " + CONFIG + "/grippers/ag95.yaml";

const std::string HEAD = "format: 1\nname: my_tube\nmesh: {file: three_way_tube.stl, unit: mm}\n";

/// Across the run of the tube, whose socket is 35 mm wide there, from the side of its branch.
std::string graspOfWidth(const std::string& width)
{
  return "grasps:\n  - {id: run, position: [0.038, 0, -0.008], approach: [0, 0, -1], closing: [0, 1, 0], width: " +
         width + ", opening: 0.060}\n";
}

/// A user's own folder: no gripper lies beside it.
class GraspsCommand : public ::testing::Test
{
protected:
  std::string partWith(const std::string& grasps) const
  {
    fs::copy_file(TUBE + "/three_way_tube.stl", folder_.path("three_way_tube.stl"),
                  fs::copy_options::overwrite_existing);
    folder_.write("part.yaml", HEAD + grasps);
    return folder_.path("");
  }

  TemporaryFolder folder_;
};

TEST_F(GraspsCommand, helpNamesItsOptions)
{
  const Outcome help = runCommand("grasps --help");
  EXPECT_EQ(help.exit_code, 0);
  expectWords(help.text, {"example: bin_picking grasps", "--gripper", "--propose", "--image", "--set"});
  EXPECT_NE(runCommand("parameters --of grasps").text.find("min_contact_area:"), std::string::npos);
}

TEST_F(GraspsCommand, goodGraspsAreToldWithTheirCoverage)
{
  const Outcome told = runCommand("grasps " + TUBE + " --image " + folder_.path("grasps.png"));
  EXPECT_EQ(told.exit_code, 0) << told.text;
  expectWords(told.text, {"three_way_tube with", "middle_from_below", "holds", "% of all attitudes"});
  EXPECT_GT(fs::file_size(folder_.path("grasps.png")), 1000u);

  const Outcome own = runCommand("grasps " + partWith(graspOfWidth("0.035")) + AG95);
  EXPECT_EQ(own.exit_code, 0) << own.text;
}

TEST_F(GraspsCommand, aBadGraspIsAFailureWithItsCure)
{
  expectCommandFails("grasps " + partWith(graspOfWidth("0.030")) + AG95, 1,
                     {"run: ", "35.0 mm", "write width: 0.0350", "1 of the 1 grasps", "would fail"});
  // What counts as bad can be set.
  EXPECT_EQ(runCommand("grasps " + partWith(graspOfWidth("0.034")) + AG95 + " --set max_width_error=2mm").exit_code, 0);
}

// Of a cube: whose search is short.
TEST_F(GraspsCommand, proposalsHoldAsTheyAre)
{
  const std::string head = "format: 1\nname: cube\nmesh: {file: cube.obj, unit: mm}\n";
  fs::copy_file(std::string(BIN_PICKING_SOURCE_DIR) + "/test/ros/cube/cube.obj", folder_.path("cube.obj"));
  folder_.write("part.yaml", head);
  const Outcome proposed = runCommand("grasps " + folder_.path("") + AG95 + " --propose 2");
  ASSERT_EQ(proposed.exit_code, 0) << proposed.text;
  ASSERT_NE(proposed.text.find("grasps:"), std::string::npos) << proposed.text;
  const std::string yaml = proposed.text.substr(proposed.text.find("grasps:"));
  folder_.write("part.yaml", head + yaml);
  const Outcome told = runCommand("grasps " + folder_.path("") + AG95);
  EXPECT_EQ(told.exit_code, 0) << yaml << told.text;
}

TEST_F(GraspsCommand, wrongUsageIsToldApartFromFailure)
{
  expectCommandFails("grasps", 2, {"PART_DIR is missing"});
  expectCommandFails("grasps " + TUBE + " --propose some", 2, {"--propose", "'some'", "whole number"});
  expectCommandFails("grasps " + TUBE + " --set frictoin=0.3", 2, {"frictoin", "did you mean 'friction'"});
  expectCommandFails("grasps " + TUBE + " --griper x.yaml", 2, {"did you mean '--gripper'"});
  expectCommandFails("grasps " + partWith(graspOfWidth("0.035")), 2, {"no gripper file beside", "--gripper"});
  expectCommandFails("grasps no_such_part", 1, {"no_such_part"});
  expectCommandFails("grasps " + TUBE + " --gripper no_such.yaml", 1, {"no_such.yaml"});
  expectCommandFails("grasps " + partWith("") + AG95, 1, {"has no grasps", "--propose"});
}
}  // namespace
}  // namespace bin_picking
