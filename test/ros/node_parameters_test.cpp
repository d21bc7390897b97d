// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "node_parameters.hpp"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <fstream>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "resource_path.hpp"
#include "tuning.hpp"

namespace
{
using namespace bin_picking_ros;
using bin_picking::ParameterError;
using XmlRpc::XmlRpcValue;

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
    parseNodeParameters(tree);
  }
  catch (const ParameterError& error)
  {
    return error.what();
  }
  return "accepted";
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

std::string readText(const std::string& path)
{
  std::ifstream file(std::string(BIN_PICKING_SOURCE_DIR) + "/" + path);
  std::stringstream text;
  text << file.rdbuf();
  EXPECT_FALSE(text.str().empty()) << path;
  return text.str();
}

TEST(NodeParameters, ReadsNestedMapsAndConfusedTypes)
{
  XmlRpcValue tree = minimalTree();
  tree["max_age"] = 3;  // a whole number for a double
  tree["process"] = "continuous";
  tree["detector"]["max_detections"] = 7.0;  // a double for a whole number
  tree["detector"]["verification"]["enabled"] = false;
  tree["grasping"]["max_tilt"] = "30deg";
  tree["training"]["leaf"] = 0.003;
  tree["tuning"]["min_matching_rate"] = 0.1;  // belongs to dynamic_reconfigure
  const NodeParameters parameters = parseNodeParameters(tree);
  EXPECT_EQ(parameters.parts, std::vector<std::string>{"/parts/block"});
  EXPECT_EQ(parameters.max_age, 3.0);
  EXPECT_EQ(parameters.process, ProcessMode::Continuous);
  EXPECT_EQ(parameters.detector.max_detections, 7);
  EXPECT_FALSE(parameters.detector.verification.enabled);
  EXPECT_NEAR(parameters.grasping.max_tilt, M_PI / 6, 1e-12);
  EXPECT_EQ(parameters.training.leaf, 0.003);
}

TEST(NodeParameters, PresetComesFirstWhateverTheOrder)
{
  XmlRpcValue tree = minimalTree();
  tree["preset"] = "paper";
  tree["detector"]["voting"]["reference_share"] = 0.07;  // "detector" is before "preset" in the alphabet
  const NodeParameters parameters = parseNodeParameters(tree);
  auto expected = bin_picking::DetectorParameters::preset("paper");
  expected.voting.reference_share = 0.07;
  auto actual = parameters.detector;
  EXPECT_EQ(bin_picking::toYaml(bin_picking::visitor(actual)), bin_picking::toYaml(bin_picking::visitor(expected)));
}

TEST(NodeParameters, ReportsMistakes)
{
  XmlRpcValue unknown = minimalTree();
  unknown["detector"]["verification"]["min_matching_rat"] = 0.5;
  EXPECT_TRUE(contains(messageOf(unknown), "min_matching_rate")) << messageOf(unknown);
  XmlRpcValue range = minimalTree();
  range["grasping"]["min_matching_rate"] = 1.5;
  EXPECT_TRUE(contains(messageOf(range), "1.5")) << messageOf(range);
  XmlRpcValue type = minimalTree();
  type["tf_timeout"] = "soon";
  EXPECT_NE(messageOf(type), "accepted");
  XmlRpcValue list = minimalTree();
  list["bin"][0] = "a";
  EXPECT_TRUE(contains(messageOf(list), "bin")) << messageOf(list);
  XmlRpcValue preset = minimalTree();
  preset["preset"] = "fats";
  EXPECT_TRUE(contains(messageOf(preset), "fast")) << messageOf(preset);
  XmlRpcValue frame_only = minimalTree();
  frame_only["bin_frame"] = "bin";
  EXPECT_TRUE(contains(messageOf(frame_only), "bin_frame")) << messageOf(frame_only);
  XmlRpcValue empty;
  empty["preset"] = "fast";
  EXPECT_TRUE(contains(messageOf(empty), "parts")) << messageOf(empty);
}

TEST(NodeParameters, SeveralParts)
{
  XmlRpcValue tree;
  tree["parts"][0] = "/a";
  tree["parts"][1] = "/b";
  EXPECT_EQ(parseNodeParameters(tree).parts, (std::vector<std::string>{"/a", "/b"}));
  tree["parts"][1] = 5;
  EXPECT_THROW(parseNodeParameters(tree), ParameterError);
}

TEST(ResourcePath, RefusesWhatDependsOnTheWorkingFolder)
{
  EXPECT_EQ(resolveResource("/a/b.yaml"), "/a/b.yaml");
  EXPECT_EQ(resolveResource("file:///a/b.yaml"), "/a/b.yaml");
  EXPECT_THROW(resolveResource("a/b.yaml"), ParameterError);
  EXPECT_THROW(resolveResource(""), ParameterError);
  EXPECT_THROW(resolveResource("package://no_such_package_here/b.yaml"), ParameterError);
}

TEST(Tuning, StartsFromTheNodesParameters)
{
  NodeParameters parameters = parseNodeParameters(minimalTree());
  parameters.detector.verification.min_matching_rate = 0.31;
  parameters.grasping.max_tilt = 0.2;
  BinPickingConfig config = toConfig(parameters);
  EXPECT_EQ(config.min_matching_rate, 0.31);
  EXPECT_EQ(config.grasp_max_tilt, 0.2);
  config.edge_depth = 0.007;
  const NodeParameters changed = withConfig(parameters, config);
  EXPECT_EQ(changed.detector.segmentation.edge_depth, 0.007);
  EXPECT_EQ(changed.detector.verification.min_matching_rate, 0.31);
  EXPECT_EQ(changed.detector.max_detections, parameters.detector.max_detections);
}

TEST(Tuning, RangesAndNamesAgreeWithTheCore)
{
  const NodeParameters parameters = parseNodeParameters(minimalTree());
  EXPECT_NO_THROW(withConfig(parameters, BinPickingConfig::__getMin__()));
  EXPECT_NO_THROW(withConfig(parameters, BinPickingConfig::__getMax__()));
  dynamic_reconfigure::Config message;
  BinPickingConfig::__getDefault__().__toMessage__(message);
  EXPECT_EQ(message.doubles.size(), tunableParameters().size());
  // Every field of the configuration reaches a parameter: what went in comes back.
  for (std::size_t i = 0; i < message.doubles.size(); ++i)
  {
    dynamic_reconfigure::Config low;
    BinPickingConfig::__getMin__().__toMessage__(low);
    BinPickingConfig config = toConfig(withConfig(parameters, BinPickingConfig::__getMin__()));
    dynamic_reconfigure::Config back;
    config.__toMessage__(back);
    EXPECT_EQ(back.doubles[i].value, low.doubles[i].value) << back.doubles[i].name;
  }
}

void copyYaml(const YAML::Node& node, XmlRpcValue& value)
{
  if (node.IsMap())
    for (const auto& entry : node)
      copyYaml(entry.second, value[entry.first.as<std::string>()]);
  else
    value = node.as<std::string>();
}

TEST(Files, DetectorYamlRepeatsTheDefaults)
{
  XmlRpcValue tree = minimalTree();
  copyYaml(YAML::Load(readText("config/detector.yaml")), tree);
  NodeParameters from_file = parseNodeParameters(tree);
  NodeParameters defaults = parseNodeParameters(minimalTree());
  const auto a = bin_picking::listParameters(bin_picking::visitor(from_file));
  const auto b = bin_picking::listParameters(bin_picking::visitor(defaults));
  for (std::size_t i = 0; i < a.size(); ++i)
    EXPECT_EQ(a[i].value, b[i].value) << a[i].path;
}

TEST(Files, DocumentationListsEveryParameterOfTheNode)
{
  const std::string document = readText("docs/ros_interface.md");
  NodeParameters parameters;
  std::istringstream table(bin_picking::toMarkdown(bin_picking::visitor(parameters)));
  for (std::string line; std::getline(table, line);)
  {
    const bool is_of_a_stage = line.rfind("| `detector/", 0) == 0 || line.rfind("| `training/", 0) == 0;
    EXPECT_TRUE(is_of_a_stage || contains(document, line + "\n")) << line;
  }
  // Nor does it list groups' parameters that there are no longer.
  std::istringstream lines(document);
  for (std::string line; std::getline(lines, line);)
  {
    const bool is_of_a_group =
        line.rfind("| `grasping/", 0) == 0 || line.rfind("| `avoid/", 0) == 0 || line.rfind("| `reach/", 0) == 0;
    EXPECT_TRUE(!is_of_a_group || contains(table.str(), line + "\n")) << line;
  }
  for (const auto& [name, path] : tunableParameters())
    EXPECT_TRUE(contains(document, "| `" + name + "` | `" + path + "` |")) << name;
}
}  // namespace
