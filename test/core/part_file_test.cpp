// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "bin_picking_perception/model/training_parameters.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using Eigen::Vector3d;
using test::expectWords;
using test::messageOf;
using test::TemporaryFolder;

const std::string GOOD = R"(format: 1
name: tee
mesh: {file: tee.stl, unit: mm}
expected_size: [0.09, 35mm, 0.0675]
symmetry:
  discrete:
    - {axis: [0, 0, 2], order: 2}
    - {axis: [1, 0, 0], order: 2, origin: [0, 0, 0]}
training:
  leaf: 3mm

  # a comment keeps its line
  d_angle: 10deg
grasps:
  - id: top
    position: [0.01, 0, 0.02]
    approach: [0, 0, -1]
    closing: [0, 1, 0]
    width: 0.035
    opening: 60mm
    approach_distance: 0.05
    retreat_distance: 0.07
    priority: 3
    symmetric: false
    tilt_tolerance_deg: 15
    spin_tolerance_deg: 180
  - id: side
    position: [0, 0, 0]
    rpy_deg: [90, 0, 90]
    width: 0.02
    opening: 0.02
)";

/// GOOD with one piece of text replaced.
std::string with(const std::string& old_text, const std::string& new_text)
{
  std::string text = GOOD;
  const auto at = text.find(old_text);
  EXPECT_NE(at, std::string::npos) << old_text;
  return text.replace(at, old_text.size(), new_text);
}

/// The message for a part.yaml of this content; it must name the file and, unless it is empty, the line.
std::string loadingError(const std::string& content, const std::string& line)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("part.yaml", content);
  const std::string message = messageOf<FileError>([&] { loadPart(path); });
  expectWords(message, {path + (line.empty() ? "" : ":" + line + ": ")});
  return message;
}

TEST(PartFile, readsEveryKey)
{
  const TemporaryFolder folder;
  folder.write("part.yaml", GOOD);
  const PartDefinition part = loadPart(folder.path(""));
  EXPECT_EQ(part.name, "tee");
  EXPECT_EQ(part.mesh_file, folder.path("tee.stl"));
  EXPECT_EQ(part.mesh_unit, LengthUnit::Millimetre);
  ASSERT_TRUE(part.expected_size);
  EXPECT_LT((*part.expected_size - Vector3d(0.09, 0.035, 0.0675)).norm(), 1e-12);
  EXPECT_EQ(part.symmetry.discrete.size(), 4u);  // two half turns make the third
  EXPECT_FALSE(part.symmetry.continuous);
  ASSERT_EQ(part.grasps.size(), 2u);
  const GraspDefinition& top = part.grasps[0];
  EXPECT_EQ(top.id, "top");
  EXPECT_LT((top.T_object_tip.translation() - Vector3d(0.01, 0, 0.02)).norm(), 1e-12);
  EXPECT_LT((top.T_object_tip.linear() * Vector3d::UnitZ() - Vector3d(0, 0, -1)).norm(), 1e-12);
  EXPECT_LT((top.T_object_tip.linear() * Vector3d::UnitY() - Vector3d(0, 1, 0)).norm(), 1e-12);
  EXPECT_NEAR(top.T_object_tip.linear().determinant(), 1, 1e-12);
  EXPECT_NEAR(top.width, 0.035, 1e-12);
  EXPECT_NEAR(top.opening, 0.06, 1e-12);
  EXPECT_NEAR(top.approach, 0.05, 1e-12);
  EXPECT_NEAR(top.retreat, 0.07, 1e-12);
  EXPECT_EQ(top.priority, 3);
  EXPECT_FALSE(top.symmetric);
  EXPECT_NEAR(top.tilt_tolerance, M_PI / 12, 1e-12);
  EXPECT_NEAR(top.spin_tolerance, M_PI, 1e-12);
  EXPECT_EQ(part.grasps[1].tilt_tolerance, 0);
  EXPECT_EQ(part.grasps[1].spin_tolerance, 0);
  EXPECT_TRUE(part.grasps[1].symmetric);
  EXPECT_EQ(part.grasps[1].priority, 0);
}

TEST(PartFile, rollPitchYawAreAboutTheFixedAxesInThatOrder)
{
  const TemporaryFolder folder;
  const PartDefinition part = loadPart(folder.write("part.yaml", GOOD));
  // 90 about x takes z to -y, then 90 about z takes -y to x.
  EXPECT_LT((part.grasps[1].T_object_tip.linear() * Vector3d::UnitZ() - Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_LT((part.grasps[1].T_object_tip.linear() * Vector3d::UnitX() - Vector3d(0, 1, 0)).norm(), 1e-12);
}

TEST(PartFile, trainingValuesApplyOverThePreset)
{
  const TemporaryFolder folder;
  for (const std::string& text :
       {GOOD, with("training:\n  leaf: 3mm\n\n  # a comment keeps its line\n  d_angle: 10deg\n",
                   "training: {leaf: 3mm, d_angle: 10deg}\n")})
  {
    const PartDefinition part = loadPart(folder.write("part.yaml", text));
    TrainingParameters parameters;
    setParametersFromYaml(visitor(parameters), part.training_yaml, "part.yaml");
    EXPECT_NEAR(parameters.leaf, 0.003, 1e-12);
    EXPECT_NEAR(parameters.d_angle, 10 * M_PI / 180, 1e-12);
    EXPECT_EQ(parameters.num_views, TrainingParameters().num_views);
  }
}

TEST(PartFile, axisOfRevolutionLeavesOneFlip)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("part.yaml", R"(
format: 1
name: tube
mesh: {file: /somewhere/tube.stl, unit: m}
symmetry:
  continuous: {axis: [0, 0, 3], origin: [0.01, 0, 0]}
  discrete: [{axis: [0, 0, 1], order: 7, origin: [0.01, 0, 0]}, {axis: [1, 0, 0], order: 2}, {axis: [1, 3, 0], order: 2, origin: [0.01, 0, 0]}]
)");
  const PartDefinition part = loadPart(path);
  EXPECT_EQ(part.mesh_file, "/somewhere/tube.stl");
  ASSERT_TRUE(part.symmetry.continuous);
  EXPECT_LT((part.symmetry.continuous->direction - Vector3d::UnitZ()).norm(), 1e-12);
  ASSERT_EQ(part.symmetry.discrete.size(), 2u);
  EXPECT_LT((part.symmetry.discrete[1].linear() * Vector3d::UnitZ() + Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_TRUE(part.grasps.empty());
}

TEST(PartFile, missingFilesAndBrokenYaml)
{
  const TemporaryFolder folder;
  expectWords(messageOf<FileError>([&] { loadPart(folder.path("")); }), {"part.yaml", "no such file"});
  expectWords(messageOf<FileError>([&] { loadPart(folder.path("other.yaml")); }), {"other.yaml", "no such file"});
  expectWords(loadingError("format: 1\nname: [tee\nmesh: x\n", ""), {"not valid YAML"});
  expectWords(loadingError("- a\n- b\n", "1"), {"must be a map"});
  expectWords(loadingError("", ""), {"must be a map"});
}

TEST(PartFile, unknownAndDoubleKeys)
{
  expectWords(loadingError(with("expected_size", "expected_sise"), "4"),
              {"expected_sise", "did you mean 'expected_size'?"});
  expectWords(loadingError(with("unit: mm", "units: mm"), "3"), {"'units'", "did you mean 'unit'?"});
  expectWords(loadingError(with("order: 2}", "ordr: 2}"), "7"), {"did you mean 'order'?"});
  expectWords(loadingError(with("closing:", "closng:"), "18"), {"did you mean 'closing'?"});
  expectWords(loadingError(with("symmetry:", "xyzzy:"), "5"), {"xyzzy", "known here are: format, name"});
  expectWords(loadingError(with("name: tee\n", "name: tee\nname: cross\n"), "3"), {"'name' is given twice"});
  expectWords(loadingError(with("leaf: 3mm", "leef: 3mm"), "10"), {"leef", "leaf"});
  expectWords(loadingError(with("d_angle: 10deg", "d_angle: 10mm"), "13"), {"d_angle", "mm"});
}

TEST(PartFile, missingKeys)
{
  expectWords(loadingError(with("format: 1\n", ""), "1"), {"'format' is missing"});
  expectWords(loadingError(with("name: tee\n", ""), "1"), {"'name' is missing"});
  expectWords(loadingError(with(", unit: mm", ""), "3"), {"no 'unit'", "m, cm, mm or inch"});
  expectWords(loadingError(with("file: tee.stl, ", ""), "3"), {"'file' is missing"});
  expectWords(loadingError(with("- id: top\n    position", "- position"), "15"), {"'id' is missing"});
  expectWords(loadingError(with("    width: 0.035\n", ""), "15"), {"'width' is missing"});
  expectWords(loadingError(with("    closing: [0, 1, 0]\n", ""), "15"), {"'closing' is missing"});
  expectWords(loadingError(with("    rpy_deg: [90, 0, 90]\n", ""), "27"),
              {"either 'approach' and 'closing', or 'rpy_deg'"});
}

TEST(PartFile, valuesOfTheWrongKind)
{
  expectWords(loadingError(with("format: 1", "format: 2"), "1"), {"format is 2", "reads format 1"});
  expectWords(loadingError(with("unit: mm", "unit: feet"), "3"), {"feet", "m, cm, mm, inch"});
  expectWords(loadingError(with("width: 0.035", "width: 12O"), "19"), {"'width'", "'12O'"});
  expectWords(loadingError(with("width: 0.035", "width: .nan"), "19"), {"'width'", ".nan"});
  expectWords(loadingError(with("width: 0.035", "width: -0.01"), "19"), {"'width'", "must lie in [0"});
  expectWords(loadingError(with("approach_distance: 0.05", "approach_distance: 50"), "21"), {"must lie in [0"});
  expectWords(loadingError(with("[0.01, 0, 0.02]", "[0.01, 0]"), "16"), {"'position'", "3 numbers", "it has 2"});
  expectWords(loadingError(with("[0.01, 0, 0.02]", "0.01"), "16"), {"'position'", "list of 3 numbers"});
  expectWords(loadingError(with("[0.09, 35mm, 0.0675]", "[0.09, 0, 0.0675]"), "4"), {"positive"});
  expectWords(loadingError(with("priority: 3", "priority: 2.5"), "23"), {"'priority'", "whole number"});
  expectWords(loadingError(with("symmetric: false", "symmetric: never"), "24"), {"'symmetric'", "true or false"});
  expectWords(loadingError(with("name: tee", "name: {}"), "2"), {"'name'", "text"});
  expectWords(loadingError(with("{file: tee.stl, unit: mm}", "tee.stl"), "3"), {"'mesh'", "map"});
}

TEST(PartFile, graspsThatCannotBe)
{
  expectWords(loadingError(with("opening: 60mm", "opening: 30mm"), "19"),
              {"'top'", "opening must be at least the width"});
  expectWords(loadingError(with("id: side", "id: top"), "27"), {"'top' is used twice"});
  expectWords(loadingError(with("closing: [0, 1, 0]", "closing: [0, 1, -1]"), "18"), {"right angle", "45"});
  expectWords(loadingError(with("closing: [0, 1, 0]", "closing: [0, 0, 0]"), "18"), {"must not be [0, 0, 0]"});
  expectWords(loadingError(with("rpy_deg:", "approach: [1, 0, 0]\n    closing: [0, 1, 0]\n    rpy_deg:"), "31"),
              {"once"});
  expectWords(loadingError(with("tolerance_deg: 15", "tolerance_deg: 95"), "25"), {"'tilt_tolerance_deg'", "[0, 90]"});
  expectWords(loadingError(with("tolerance_deg: 180", "tolerance_deg: -1"), "26"),
              {"'spin_tolerance_deg'", "[0, 180]"});
  expectWords(loadingError("format: 1\nname: a\nmesh: {file: a.stl, unit: mm}\ngrasps: {id: a}\n", "4"), {"list"});
  expectWords(loadingError("format: 1\nname: a\nmesh: {file: a.stl, unit: mm}\ngrasps: [a]\n", "4"), {"map"});
}

TEST(PartFile, symmetriesThatCannotBe)
{
  expectWords(loadingError(with("[0, 0, 2], order: 2", "[0, 0, 2], order: 1"), "7"), {"'order' is 1", "[2, 120]"});
  expectWords(loadingError(with("[0, 0, 2], order: 2", "[1, 0, 2], order: 2"), "6"), {"more than 120"});
  expectWords(loadingError(with("[0, 0, 2], order: 2", "[0, 0, 0], order: 2"), "7"), {"must not be [0, 0, 0]"});
  expectWords(loadingError(with("symmetry:\n", "symmetry:\n  continuous: {axis: [0, 1, 1]}\n"), "8"),
              {"moves the axis of revolution"});
}

TEST(PartFile, expectedSizeIsCompared)
{
  PartDefinition part;
  part.mesh_file = "tee.stl";
  part.mesh_unit = LengthUnit::Centimetre;
  EXPECT_NO_THROW(checkExpectedSize(part, Vector3d(1, 2, 3)));
  part.expected_size = Vector3d(0.1, 0.02, 0.03);
  EXPECT_NO_THROW(checkExpectedSize(part, Vector3d(0.1009, 0.0204, 0.0296)));  // 1 % or 0.5 mm
  expectWords(messageOf<FileError>([&] { checkExpectedSize(part, Vector3d(0.1, 0.0206, 0.03)); }), {"tee.stl", "'cm'"});
  EXPECT_THROW(checkExpectedSize(part, Vector3d(1, 0.2, 0.3)), FileError);
}

TEST(PartFile, symmetryMayStandInAModelsInfo)
{
  const TemporaryFolder folder;
  folder.write("models_info.json",
               R"({"3": {"diameter": 90, "min_x": 0, "min_y": 0, "min_z": 0, "size_x": 50, "size_y": 50,
    "size_z": 50, "symmetries_discrete": [[-1, 0, 0, 4, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]]}})");
  const std::string head = "format: 1\nname: tee\nmesh: {file: tee.stl, unit: mm}\nsymmetry:\n";
  const auto load = [&](const std::string& symmetry) { return loadPart(folder.write("part.yaml", head + symmetry)); };
  const PartDefinition part = load("  models_info: {file: models_info.json, id: 3}\n");
  const std::vector<std::string> files = {"part.yaml", "tee.stl", "models_info.json"};
  ASSERT_EQ(part.files.size(), files.size());
  for (std::size_t k = 0; k < files.size(); ++k)
    EXPECT_EQ(part.files[k], folder.path(files[k]));
  ASSERT_EQ(part.symmetry.discrete.size(), 2u);
  EXPECT_LT((part.symmetry.discrete[1] * Vector3d::Zero() - Vector3d(0.004, 0, 0)).norm(), 1e-12);
  const auto error = [&](const std::string& symmetry) { return messageOf<FileError>([&] { load(symmetry); }); };
  expectWords(error("  models_info: {file: models_info.json, id: 4}\n"), {"part.yaml:5", "no model 4", "[3, 3]"});
  expectWords(error("  models_info: {file: missing.json, id: 3}\n"), {folder.path("missing.json")});
  expectWords(error("  models_info: {file: models_info.json, id: 3}\n  discrete: []\n"), {"part.yaml:5", "twice"});
}

TEST(PartFile, documentationAndDemoPartsAreReadable)
{
  const std::string parts = std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/";
  const std::string readme = test::readFile(parts + "README.md");
  const auto begin = readme.find("```yaml\n") + 8;
  const TemporaryFolder folder;
  const PartDefinition documented =
      loadPart(folder.write("part.yaml", readme.substr(begin, readme.find("```", begin) - begin)));
  EXPECT_EQ(documented.grasps.size(), 12u) << "one, and its copies around the axis";
  for (const char* name : {"three_way_tube", "upright_column"})
  {
    const PartDefinition part = loadPart(parts + name);
    EXPECT_EQ(part.name, name);
    EXPECT_FALSE(part.grasps.empty());
    EXPECT_NO_THROW(checkExpectedSize(part, inspectMesh(loadMesh(part.mesh_file, part.mesh_unit)).size));
  }
}
TEST(PartFile, AGraspIsCopiedAroundAnAxis)
{
  const TemporaryFolder folder;
  const std::string file =
      folder.write("part.yaml", with("    spin_tolerance_deg: 180\n",
                                     "    around: {axis: [0, 0, 2], origin: [0.01, 0, 0], from_deg: -90, to_deg: 180, "
                                     "step_deg: 90}\n"));
  const auto grasps = loadPart(file).grasps;
  ASSERT_EQ(grasps.size(), 5u);
  EXPECT_EQ(grasps[0].id, "top");
  const Vector3d origin(0.01, 0, 0);
  for (const auto& [index, id, angle] :
       {std::tuple(1u, "top@-90", -90), std::tuple(2u, "top@90", 90), std::tuple(3u, "top@180", 180)})
  {
    const GraspDefinition& copy = grasps[index];
    EXPECT_EQ(copy.id, id);
    const Eigen::AngleAxisd turn(angle * M_PI / 180, Vector3d::UnitZ());
    EXPECT_TRUE(copy.T_object_tip.linear().isApprox(turn * grasps[0].T_object_tip.linear(), 1e-12));
    const Vector3d arm = grasps[0].T_object_tip.translation() - origin;
    EXPECT_TRUE(copy.T_object_tip.translation().isApprox(origin + turn * arm, 1e-12));
    EXPECT_EQ(copy.width, grasps[0].width);
    EXPECT_EQ(copy.priority, grasps[0].priority);
  }
  EXPECT_EQ(grasps[4].id, "side");
}

TEST(PartFile, ACircleOfGraspsClosesOnceAndItsAnglesAreChecked)
{
  const auto grasps = [](const std::string& around) {
    const TemporaryFolder folder;
    return loadPart(folder.write("part.yaml", with("    spin_tolerance_deg: 180\n", "    around: " + around + "\n")))
        .grasps;
  };
  EXPECT_EQ(grasps("{axis: [0, 0, 1], from_deg: 0, to_deg: 360, step_deg: 120}").size(), 4u) << "0, 120, 240, and side";
  for (const char* const wrong :
       {"{axis: [0, 0, 1], from_deg: 90, to_deg: 0, step_deg: 30}",
        "{axis: [0, 0, 1], from_deg: 0, to_deg: 90, step_deg: 0}",
        "{axis: [0, 0, 0], from_deg: 0, to_deg: 90, step_deg: 30}", "{axis: [0, 0, 1], from_deg: 0, to_deg: 90}",
        "{axis: [0, 0, 1], from_deg: 0, to_deg: 90, step_deg: 30, centre: [0, 0, 0]}"})
    EXPECT_THROW(grasps(wrong), FileError) << wrong;
}

}  // namespace
}  // namespace bin_picking
