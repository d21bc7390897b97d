// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "virtual_cell_parameters.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "pickable_cell.hpp"

namespace
{
using namespace bin_picking_ros;
using bin_picking::ParameterError;
using XmlRpc::XmlRpcValue;

const std::string SOURCE_DIR = BIN_PICKING_SOURCE_DIR;

XmlRpcValue minimalTree()
{
  XmlRpcValue tree;
  tree["parts"] = "/parts/block";
  return tree;
}

std::string messageOf(const XmlRpcValue& tree)
{
  try
  {
    parseVirtualCellParameters(tree);
  }
  catch (const ParameterError& error)
  {
    return error.what();
  }
  return "accepted";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(VirtualCellParameters, ReadsListsAndTextsWithCommas)
{
  XmlRpcValue tree = minimalTree();
  EXPECT_EQ(parseVirtualCellParameters(tree).counts, std::vector<int>{DEFAULT_PART_COUNT});
  tree["counts"] = 7;
  EXPECT_EQ(parseVirtualCellParameters(tree).counts, std::vector<int>{7});
  tree["parts"] = "/a, /b";
  EXPECT_EQ(parseVirtualCellParameters(tree).parts, (std::vector<std::string>{"/a", "/b"}));
  EXPECT_EQ(parseVirtualCellParameters(tree).counts, (std::vector<int>{7, 7}));
  tree["counts"] = "3, 4";
  EXPECT_EQ(parseVirtualCellParameters(tree).counts, (std::vector<int>{3, 4}));
  XmlRpcValue list;
  list[0] = 5;
  list[1] = 6.0;  // as YAML of a launch file may have it
  tree["counts"] = list;
  EXPECT_EQ(parseVirtualCellParameters(tree).counts, (std::vector<int>{5, 6}));
}

TEST(VirtualCellParameters, TypeOfTheSensorBringsDefaultsThatTheOthersReplace)
{
  XmlRpcValue tree = minimalTree();
  tree["sensor"]["height"] = 77;  // before "type" in the alphabet
  tree["sensor"]["type"] = "stereo";
  tree["sensor"]["width"] = 99;
  auto expected = bin_picking::simulation::sensorDefaults(bin_picking::simulation::SensorClass::Stereo);
  expected.height = 77;
  expected.width = 99;
  auto actual = parseVirtualCellParameters(tree).cell.sensor;
  EXPECT_EQ(bin_picking::toYaml(bin_picking::visitor(actual)), bin_picking::toYaml(bin_picking::visitor(expected)));
}

TEST(VirtualCellParameters, ReportsMistakes)
{
  XmlRpcValue unknown = minimalTree();
  unknown["failure_probabilty"] = 0.5;
  EXPECT_TRUE(contains(messageOf(unknown), "failure_probability")) << messageOf(unknown);
  XmlRpcValue nested = minimalTree();
  nested["layout"]["bin_lenght"] = 0.5;
  EXPECT_TRUE(contains(messageOf(nested), "layout/bin_length")) << messageOf(nested);
  XmlRpcValue probability = minimalTree();
  probability["drop_probability"] = -0.1;
  EXPECT_TRUE(contains(messageOf(probability), "-0.1")) << messageOf(probability);
  XmlRpcValue counts = minimalTree();
  counts["counts"] = "many";
  EXPECT_TRUE(contains(messageOf(counts), "many")) << messageOf(counts);
  counts["counts"] = "1, 2";
  EXPECT_TRUE(contains(messageOf(counts), "2 numbers for 1 part")) << messageOf(counts);
  XmlRpcValue empty;
  empty["seed"] = 1;
  EXPECT_TRUE(contains(messageOf(empty), "parts")) << messageOf(empty);
}

TEST(Files, BinOfTheDefaultLayoutIsThatOfTheFile)
{
  VirtualCellParameters parameters;
  parameters.parts = {SOURCE_DIR + "/test/ros/step_block"};
  parameters.counts = {1};
  parameters.cell.sensor.width = parameters.cell.sensor.height = 64;
  PickableCell cell(parameters);
  cell.refill([](double) {});
  const bin_picking::Bin& actual = cell.cell().bin();
  const bin_picking::Bin file = bin_picking::loadBin(SOURCE_DIR + "/config/bins/virtual_cell.yaml");
  EXPECT_TRUE(file.T_camera_bin.isApprox(actual.T_camera_bin, 1e-9));
  EXPECT_TRUE(file.inner_size.isApprox(actual.inner_size, 1e-12));
  EXPECT_NEAR(file.wall_thickness, actual.wall_thickness, 1e-12);
}

TEST(Files, DocumentationListsEveryParameterOfTheCell)
{
  std::ifstream file(SOURCE_DIR + "/docs/ros_interface.md");
  std::stringstream document;
  document << file.rdbuf();
  VirtualCellParameters parameters;
  std::istringstream table(bin_picking::toMarkdown(bin_picking::visitor(parameters)));
  for (std::string line; std::getline(table, line);)
  {
    const bool is_listed_elsewhere = line.rfind("| `sensor/", 0) == 0 || line.rfind("| `physics/", 0) == 0;
    EXPECT_TRUE(is_listed_elsewhere || contains(document.str(), line + "\n")) << line;
  }
}
}  // namespace
