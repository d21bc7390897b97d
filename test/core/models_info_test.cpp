// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/models_info.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "mesh_shapes.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using Eigen::Vector3d;
using test::expectWords;
using test::messageOf;
using test::TemporaryFolder;

const std::string BOX =
    R"("diameter": 100, "min_x": -30, "min_y": -20, "min_z": 0, "size_x": 60, "size_y": 40, "size_z": 50)";

ModelInfo loadOne(const std::string& fields)
{
  const TemporaryFolder folder;
  const auto models = loadModelsInfo(folder.write("models_info.json", "{\"7\": {" + fields + "}}"));
  EXPECT_EQ(models.size(), 1u);
  return models.at(7);
}

/// The message for a model with these fields beside the box; it must name the file and the model.
std::string errorOf(const std::string& fields)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("models_info.json", "{\"7\": {" + fields + "}}");
  std::string message = messageOf<FileError>([&] { loadModelsInfo(path); });
  expectWords(message, {path, "model 7"});
  return message;
}

Pose turn(double angle_deg, const Vector3d& axis, const Vector3d& origin = Vector3d::Zero())
{
  return Pose(Eigen::Translation3d(origin) * Eigen::AngleAxisd(angle_deg * M_PI / 180, axis.normalized()) *
              Eigen::Translation3d(-origin));
}

void expectSame(const ModelInfo& a, const ModelInfo& b)
{
  EXPECT_NEAR(a.diameter, b.diameter, 1e-12);
  EXPECT_LT((a.min_corner - b.min_corner).norm(), 1e-12);
  EXPECT_LT((a.size - b.size).norm(), 1e-12);
  ASSERT_EQ(a.symmetry.discrete.size(), b.symmetry.discrete.size());
  for (std::size_t i = 0; i < a.symmetry.discrete.size(); ++i)
    EXPECT_LT((a.symmetry.discrete[i].matrix() - b.symmetry.discrete[i].matrix()).norm(), 1e-10) << i;
  ASSERT_EQ(a.symmetry.continuous.has_value(), b.symmetry.continuous.has_value());
  if (!a.symmetry.continuous)
    return;
  EXPECT_LT((a.symmetry.continuous->direction - b.symmetry.continuous->direction).norm(), 1e-10);
  EXPECT_LT((a.symmetry.continuous->origin - b.symmetry.continuous->origin).norm(), 1e-12);
}

TEST(ModelsInfo, millimetresBecomeMetres)
{
  const ModelInfo info = loadOne(BOX + R"(, "color": "red",
    "symmetries_discrete": [[-1, 0, 0, 4, 0, -1, 0, -2, 0, 0, 1, 0, 0, 0, 0, 1]])");
  EXPECT_NEAR(info.diameter, 0.1, 1e-15);
  EXPECT_LT((info.min_corner - Vector3d(-0.03, -0.02, 0)).norm(), 1e-15);
  EXPECT_LT((info.size - Vector3d(0.06, 0.04, 0.05)).norm(), 1e-15);
  EXPECT_FALSE(info.symmetry.continuous);
  ASSERT_EQ(info.symmetry.discrete.size(), 2u);
  EXPECT_EQ(info.symmetry.discrete[0].matrix(), Pose::Identity().matrix());
  // A half turn about the line x = 2 mm, y = -1 mm.
  EXPECT_LT((info.symmetry.discrete[1].matrix() - turn(180, {0, 0, 1}, {0.002, -0.001, 0}).matrix()).norm(), 1e-12);
}

TEST(ModelsInfo, matricesAreGivenRowByRow)
{
  const ModelInfo info =
      loadOne(BOX + R"(, "symmetries_discrete": [[0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]])");
  ASSERT_EQ(info.symmetry.discrete.size(), 4u);
  EXPECT_LT((info.symmetry.discrete[1] * Vector3d::UnitX() - Vector3d::UnitY()).norm(), 1e-12);
}

TEST(ModelsInfo, addsTheProductsThatTheListMayLack)
{
  // Two half turns make the third; the identity is listed although it need not be.
  const ModelInfo info = loadOne(BOX + R"(, "symmetries_discrete": [
    [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],
    [1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1],
    [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1]])");
  EXPECT_EQ(info.symmetry.discrete.size(), 4u);
}

TEST(ModelsInfo, fittedMotionsCountAsTheRotationThatTheyAreMeantToBe)
{
  // A half turn as it is fitted to a scan, with six digits: its square misses the identity by 0.4 degrees and 0.16 mm.
  const ModelInfo info = loadOne(BOX + R"(, "symmetries_discrete": [[-0.999964, -0.00333777, -0.0077452, 0.232611,
    0.00321462, -0.999869, 0.0158593, 0.694388, -0.00779712, 0.0158338, 0.999844, -0.0792063, 0, 0, 0, 1]])");
  ASSERT_EQ(info.symmetry.discrete.size(), 2u);
  const Eigen::Matrix3d R = info.symmetry.discrete[1].linear();
  EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-12);
  EXPECT_NEAR(R(0, 0), -0.999964, 2e-6);  // the six digits leave a millionth of skew, half of it in each column
}

TEST(ModelsInfo, readsTheAxisOfRevolutionWithItsFlip)
{
  const ModelInfo info = loadOne(BOX + R"(, "symmetries_continuous": [{"axis": [0, 0, 1], "offset": [3, 0, 0]}],
    "symmetries_discrete": [[1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 50, 0, 0, 0, 1],
                            [-1, 0, 0, 6, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]])");
  ASSERT_TRUE(info.symmetry.continuous);
  EXPECT_LT((info.symmetry.continuous->direction - Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_LT((info.symmetry.continuous->origin - Vector3d(0.003, 0, 0)).norm(), 1e-12);
  ASSERT_EQ(info.symmetry.discrete.size(), 2u);  // the half turn about the axis belongs to the revolution
  EXPECT_LT((info.symmetry.discrete[1] * Vector3d(0.003, 0, 0.05) - Vector3d(0.003, 0, 0)).norm(), 1e-12);
}

TEST(ModelsInfo, emptyListsAndNullMeanNone)
{
  for (const std::string lists : {R"(, "symmetries_discrete": [], "symmetries_continuous": [])",
                                  R"(, "symmetries_discrete": null, "symmetries_continuous": null)"})
    EXPECT_TRUE(loadOne(BOX + lists).symmetry.trivial());
}

TEST(ModelsInfo, whatIsWrittenReadsBackTheSame)
{
  std::map<int, ModelInfo> models;
  for (const int id : {2, 10, 1})
  {
    models[id].diameter = 0.1 + id / 300.0;
    models[id].min_corner = Vector3d(-0.01, 1 / 70.0, -0.03);
    models[id].size = Vector3d(0.05, 0.04, id / 700.0);
  }
  models[1].symmetry.discrete =
      closeUnderComposition({turn(60, {0, 0, 1}, {0.001, 0.002, 0}), turn(180, {1, 0, 0}, {0, 0.002, 0})});
  models[10].symmetry.continuous = Symmetry::Axis{Vector3d(1, 2, 3).normalized(), Vector3d(0.004, 0, -0.001)};
  models[10].symmetry.discrete.push_back(turn(180, {2, -1, 0}, {0.004, 0, -0.001}));
  const TemporaryFolder folder;
  const std::string path = folder.path("models_info.json");
  saveModelsInfo(models, path);
  const auto again = loadModelsInfo(path);
  ASSERT_EQ(again.size(), models.size());
  for (const auto& [id, info] : models)
    expectSame(again.at(id), info);
  EXPECT_EQ(models[1].symmetry.discrete.size(), 12u);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path("")), {}), 1);
}

TEST(ModelsInfo, writesTheFormOfTheBenchmark)
{
  std::map<int, ModelInfo> models;
  models[10].diameter = 0.075;
  models[10].min_corner = Vector3d(-0.03, -0.02, -0.01);
  models[10].size = Vector3d(0.06, 0.04, 0.02);
  models[2] = models[10];
  models[2].symmetry.discrete.push_back(turn(180, {0, 0, 1}, {0.002, 0, 0}));
  models[2].symmetry.continuous = Symmetry::Axis{Vector3d::UnitX(), Vector3d(0, 0, 0.01)};
  const TemporaryFolder folder;
  saveModelsInfo(models, folder.path("models_info.json"));
  const std::string text = test::readFile(folder.path("models_info.json"));
  expectWords(text, {"\"size_x\":60.0", "\"min_z\":-10.0",
                     "\"symmetries_discrete\":[[-1.0,0.0,0.0,4.0,0.0,-1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0]]",
                     "\"symmetries_continuous\":[{\"axis\":[1.0,0.0,0.0],\"offset\":[0.0,0.0,10.0]}]"});
  EXPECT_LT(text.find("\"2\""), text.find("\"10\""));
  EXPECT_EQ(text.find("symmetries", text.find("\"10\"")), std::string::npos);
}

TEST(ModelsInfo, describesAMesh)
{
  TriangleMesh mesh = test::box(0.06f, 0.04f, 0.02f);
  for (auto& vertex : mesh.vertices)
    vertex += Eigen::Vector3f(0.01f, 0, 0);
  Symmetry symmetry;
  symmetry.discrete.push_back(turn(180, {1, 0, 0}));
  const ModelInfo info = describeModel(mesh, symmetry);
  EXPECT_NEAR(info.diameter, std::sqrt(0.06 * 0.06 + 0.04 * 0.04 + 0.02 * 0.02), 1e-8);  // float vertices
  EXPECT_LT((info.min_corner - Vector3d(-0.02, -0.02, -0.01)).norm(), 1e-8);
  EXPECT_LT((info.size - Vector3d(0.06, 0.04, 0.02)).norm(), 1e-8);
  EXPECT_EQ(info.symmetry.discrete.size(), 2u);
  EXPECT_THROW(describeModel({}, {}), ParameterError);
}

TEST(ModelsInfo, refusesDamagedModels)
{
  expectWords(errorOf(R"("min_x": 0)"), {"'diameter' is missing"});
  expectWords(errorOf(R"("diameter": 100, "min_x": 0, "min_y": 0, "min_z": 0, "size_x": 1, "size_y": 1)"),
              {"'size_z'"});
  expectWords(errorOf(R"("diameter": "100")"), {"'diameter'", "\"100\"", "number"});
  // Written in metres.
  expectWords(
      errorOf(R"("diameter": 0.1, "min_x": 0, "min_y": 0, "min_z": 0, "size_x": 0.1, "size_y": 0.1, "size_z": 0)"),
      {"0.1 mm", "[2, 2000] mm"});
  expectWords(
      errorOf(R"("diameter": 100, "min_x": 0, "min_y": 0, "min_z": 0, "size_x": 1, "size_y": 140, "size_z": 0)"),
      {"'size_y'", "140 mm", "[0, 100] mm"});
}

TEST(ModelsInfo, refusesDamagedSymmetries)
{
  const auto discrete = [](const std::string& entry) { return errorOf(BOX + ", \"symmetries_discrete\": " + entry); };
  expectWords(discrete("[[1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]]"), {"symmetries_discrete[0]", "16 numbers", "12"});
  expectWords(discrete("{}"), {"'symmetries_discrete'", "list"});
  expectWords(discrete("[[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, null, 0, 0, 0, 0, 1]]"),
              {"symmetries_discrete[0][10]", "null"});
  expectWords(discrete("[[1, 0, 0, 0, 0, 1.1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]]"), {"no rotation", "0.21", "0.002"});
  expectWords(discrete("[[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1]]"), {"mirrors"});
  // Column by column, so that the translation stands last.
  expectWords(discrete("[[1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 50, 1]]"), {"last row", "row by row"});
  // Two half turns about parallel axes make a translation.
  expectWords(
      discrete(
          "[[-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], [-1, 0, 0, 9, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]]"),
      {"more than 120"});
  const auto continuous = [](const std::string& list) { return errorOf(BOX + ", \"symmetries_continuous\": " + list); };
  expectWords(continuous(R"([{"axis": [0, 0, 2], "offset": [0, 0, 0]}])"),
              {"symmetries_continuous[0].axis", "length 2"});
  expectWords(continuous(R"([{"axis": [0, 0, 0], "offset": [0, 0, 0]}])"), {"length 0", "unit"});
  expectWords(continuous(R"([{"axis": [0, 1], "offset": [0, 0, 0]}])"), {"3 numbers"});
  expectWords(continuous(R"([{"axis": [0, 0, 1]}])"), {"'offset'"});
  expectWords(continuous(R"([{"axis": [0, 0, 1], "offset": [0, 0, 0]}, {"axis": [1, 0, 0], "offset": [0, 0, 0]}])"),
              {"2 axes"});
  expectWords(continuous(R"([{"axis": [0, 0, 1], "offset": [0, 0, 0]}],
    "symmetries_discrete": [[0, -1, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0, 0, 0, 0, 1]])"),
              {"symmetries_discrete[0] moves the axis"});
}

TEST(ModelsInfo, refusesWhatIsNoModelsInfo)
{
  const TemporaryFolder folder;
  const auto message = [&](const std::string& content) {
    const std::string path = folder.write("models_info.json", content);
    std::string text = messageOf<FileError>([&] { loadModelsInfo(path); });
    expectWords(text, {path});
    return text;
  };
  expectWords(message("{\"1\": {" + BOX + "}"), {"not JSON"});
  expectWords(message(""), {"not JSON"});
  expectWords(message("{\"1\": {\"diameter\": 1e999}}"), {"not JSON", "1e999"});
  expectWords(message("[]"), {"no model"});
  expectWords(message("{}"), {"no model"});
  expectWords(message("{\"1\": 3}"), {"model 1", "object"});
  expectWords(message("{\"-1\": {" + BOX + "}}"), {"model -1", "no id"});
  expectWords(message("{\"obj_1\": {" + BOX + "}}"), {"model obj_1", "no id"});
  expectWords(message("{\"1\": {" + BOX + "}, \"01\": {" + BOX + "}}"), {"twice"});
  EXPECT_THROW(loadModelsInfo(folder.path("missing.json")), FileError);
  EXPECT_THROW(loadModelsInfo(folder.path("")), FileError);
}

TEST(ModelsInfo, aFailedWriteLeavesTheOldFile)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("models_info.json", "old");
  std::map<int, ModelInfo> models;
  models[-1] = describeModel(test::box(0.06f, 0.04f, 0.02f), {});
  EXPECT_THROW(saveModelsInfo(models, path), ParameterError);
  models[1] = models[-1];
  models.erase(-1);
  models[2].diameter = NAN;
  EXPECT_THROW(saveModelsInfo(models, path), ParameterError);
  models.erase(2);
  EXPECT_EQ(test::readFile(path), "old");
  EXPECT_THROW(saveModelsInfo(models, folder.path("no_such_folder/models_info.json")), FileError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path("")), {}), 1);
  // The name is that of a folder: found out only when the new file is to take its place.
  std::filesystem::create_directory(folder.path("folder"));
  EXPECT_THROW(saveModelsInfo(models, folder.path("folder")), FileError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path("")), {}), 2);
}
}  // namespace
}  // namespace bin_picking
