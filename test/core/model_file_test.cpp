// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <iterator>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "hand_made_model.hpp"
#include "mesh_shapes.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using test::expectWords;
using test::messageOf;
using test::TemporaryFolder;

constexpr std::size_t HEADER_SIZE = 32;

TrainedModel someModel()
{
  TrainedModel model = test::modelOf(test::torus(0.03, 0.01, 4000), 0.006, FeatureKind::CurPpf);
  model.name = "ring";
  model.mesh_hash = 0x123456789abcdef0ull;
  model.parameter_hash = 42;
  model.parameters.d_cur = 1.0 / 3;  // needs all its digits
  model.symmetry.discrete.emplace_back(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  model.symmetry.continuous = Symmetry::Axis{Eigen::Vector3d::UnitZ(), Eigen::Vector3d(0.1, 0.2, 0.3)};
  model.mesh = test::box(0.08f, 0.08f, 0.02f);
  model.mesh.repairs = {"The mesh was turned."};
  model.size = {0.08, 0.08, 0.02};
  model.center = {0.001, 0.002, 0.003};
  model.views = {{Eigen::Vector3f::UnitX(), 0.01f, 0.4f, {0, 2, 5}}, {Eigen::Vector3f::UnitY(), 0.02f, 0.5f, {}}};
  model.points.curvature[3] = std::nanf("");
  model.remarks = {"It is round."};
  model.field = DistanceField(model.surface, 0.003, 0.009);
  const Symmetry::Axis axis{Eigen::Vector3d::UnitY(), Eigen::Vector3d(0.01, 0, 0.02)};
  model.near_crease.assign(model.surface.size(), 0);
  model.near_crease[2] = 1;
  model.edges = select(model.surface, {1, 3, 5, 7, 11});
  FeatureQuantizer quantizer = model.table.quantizer();
  quantizer.curvature_bins = 1;
  model.edge_table = FeatureTable(model.points, model.edges, {}, quantizer, Executor(1));
  model.near_symmetries = {{rotationAbout(axis, 0.5), axis, 0.125, 0.004, true, false}};
  return model;
}

void expectEqual(const OrientedPoints& a, const OrientedPoints& b)
{
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.normals, b.normals);
  ASSERT_EQ(a.curvature.size(), b.curvature.size());
  for (std::size_t i = 0; i < a.curvature.size(); ++i)
  {
    EXPECT_TRUE(a.curvature[i] == b.curvature[i] || (std::isnan(a.curvature[i]) && std::isnan(b.curvature[i])));
  }
}

void expectEqual(const FeatureTable& a, const FeatureTable& b)
{
  EXPECT_EQ(a.numKeys(), b.numKeys());
  ASSERT_EQ(a.numEntries(), b.numEntries());
  for (std::size_t i = 0; i < a.numEntries(); ++i)
    EXPECT_EQ(a.entries()[i].bits, b.entries()[i].bits);
  EXPECT_EQ(a.quantizer().distance_step, b.quantizer().distance_step);
  EXPECT_EQ(a.quantizer().distance_bins, b.quantizer().distance_bins);
  EXPECT_EQ(a.quantizer().curvature_min, b.quantizer().curvature_min);
  EXPECT_EQ(a.quantizer().curvature_bins, b.quantizer().curvature_bins);
  EXPECT_EQ(a.references(), b.references());
  for (std::uint32_t key = 0; key < a.quantizer().numGeometricKeys(); ++key)
  {
    ASSERT_EQ(a.hasCell(key), b.hasCell(key));
    EXPECT_EQ(a.find(key, 1, 2).begin, b.find(key, 1, 2).begin);
    EXPECT_EQ(a.find(key, 1, 2).end, b.find(key, 1, 2).end);
  }
}

TEST(ModelFile, roundTripKeepsEveryField)
{
  const TemporaryFolder folder;
  const TrainedModel saved = someModel();
  ASSERT_GT(saved.table.numEntries(), 1000u);
  saveModel(saved, folder.path("ring.bppm"));
  const auto loaded = loadModel(folder.path("ring.bppm"));
  EXPECT_EQ(loaded->name, saved.name);
  EXPECT_EQ(loaded->mesh_hash, saved.mesh_hash);
  EXPECT_EQ(loaded->parameter_hash, saved.parameter_hash);
  TrainingParameters expected = saved.parameters;
  TrainingParameters found = loaded->parameters;
  EXPECT_EQ(toYaml(visitor(found)), toYaml(visitor(expected)));
  EXPECT_EQ(loaded->parameters.d_cur, saved.parameters.d_cur);
  ASSERT_EQ(loaded->symmetry.discrete.size(), 2u);
  EXPECT_EQ(loaded->symmetry.discrete[1].matrix(), saved.symmetry.discrete[1].matrix());
  ASSERT_TRUE(loaded->symmetry.continuous);
  EXPECT_EQ(loaded->symmetry.continuous->direction, saved.symmetry.continuous->direction);
  EXPECT_EQ(loaded->symmetry.continuous->origin, saved.symmetry.continuous->origin);
  EXPECT_EQ(loaded->mesh.vertices, saved.mesh.vertices);
  EXPECT_EQ(loaded->mesh.triangles, saved.mesh.triangles);
  EXPECT_EQ(loaded->mesh.repairs, saved.mesh.repairs);
  EXPECT_EQ(loaded->size, saved.size);
  EXPECT_EQ(loaded->center, saved.center);
  EXPECT_EQ(loaded->diameter, saved.diameter);
  expectEqual(loaded->points, saved.points);
  expectEqual(loaded->surface, saved.surface);
  ASSERT_EQ(loaded->views.size(), 2u);
  EXPECT_EQ(loaded->views[0].direction, saved.views[0].direction);
  EXPECT_EQ(loaded->views[0].area, saved.views[0].area);
  EXPECT_EQ(loaded->views[0].contour, saved.views[0].contour);
  EXPECT_EQ(loaded->views[0].visible, saved.views[0].visible);
  EXPECT_EQ(loaded->classes.low_max, saved.classes.low_max);
  EXPECT_EQ(loaded->classes.high_min, saved.classes.high_min);
  expectEqual(loaded->table, saved.table);
  expectEqual(loaded->edges, saved.edges);
  ASSERT_GT(saved.edge_table.numEntries(), 100u);
  expectEqual(loaded->edge_table, saved.edge_table);
  EXPECT_EQ(loaded->remarks, saved.remarks);
  EXPECT_EQ(loaded->field.band(), saved.field.band());
  for (float x = -0.05f; x < 0.05f; x += 0.0013f)
    EXPECT_EQ(loaded->field.at({x, 0.01f, 0.002f}), saved.field.at({x, 0.01f, 0.002f}));
  EXPECT_EQ(loaded->near_crease, saved.near_crease);
  ASSERT_EQ(loaded->near_symmetries.size(), 1u);
  EXPECT_EQ(loaded->near_symmetries[0].T_object_object.matrix(), saved.near_symmetries[0].T_object_object.matrix());
  EXPECT_EQ(loaded->near_symmetries[0].axis.direction, saved.near_symmetries[0].axis.direction);
  EXPECT_EQ(loaded->near_symmetries[0].axis.origin, saved.near_symmetries[0].axis.origin);
  EXPECT_EQ(loaded->near_symmetries[0].broken, saved.near_symmetries[0].broken);
  EXPECT_EQ(loaded->near_symmetries[0].deviation, saved.near_symmetries[0].deviation);
  EXPECT_TRUE(loaded->near_symmetries[0].slight);
  EXPECT_FALSE(loaded->near_symmetries[0].slight_all_around);
}

TEST(ModelFile, savingAgainGivesTheSameBytesAndNothingElse)
{
  const TemporaryFolder folder;
  saveModel(someModel(), folder.path("a"));
  saveModel(*loadModel(folder.path("a")), folder.path("b"));
  saveModel(*loadModel(folder.path("a")), folder.path("b"));  // over an old one
  EXPECT_EQ(test::readFile(folder.path("a")), test::readFile(folder.path("b")));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path("")), {}), 2);  // no temporary file stays
}

TEST(ModelFile, emptyModelIsAModel)
{
  const TemporaryFolder folder;
  saveModel(TrainedModel(), folder.path("empty"));
  EXPECT_EQ(loadModel(folder.path("empty"))->table.numEntries(), 0u);
}

class DamagedModelFile : public testing::Test
{
protected:
  DamagedModelFile()
  {
    saveModel(someModel(), folder_.path("good"));
    good_ = test::readFile(folder_.path("good"));
  }
  std::string loadingError(const std::string& content)
  {
    const std::string path = folder_.write("damaged", content);
    const std::string message = messageOf<ModelFileError>([&] { loadModel(path); });
    expectWords(message, {path, "train the part again"});
    return message;
  }

  TemporaryFolder folder_;
  std::string good_;
};

TEST_F(DamagedModelFile, missing)
{
  expectWords(messageOf<ModelFileError>([&] { loadModel(folder_.path("none")); }), {"none", "does not exist"});
  expectWords(messageOf<ModelFileError>([&] { loadModel(folder_.path(".")); }), {"does not exist or may not be read"});
}

TEST_F(DamagedModelFile, notAModel)
{
  expectWords(loadingError(""), {"not a model file"});
  expectWords(loadingError("BPP"), {"not a model file"});
  expectWords(loadingError("# .PCD v0.7 - Point Cloud Data file format"), {"not a model file", "BPPMODEL"});
}

TEST_F(DamagedModelFile, otherVersion)
{
  std::string other = good_;
  other[8] = static_cast<char>(MODEL_FILE_VERSION + 1);
  expectWords(loadingError(other), {"version " + std::to_string(MODEL_FILE_VERSION + 1)});
  std::string swapped = good_;
  std::swap(swapped[12], swapped[15]);
  expectWords(loadingError(swapped), {"byte order"});
}

TEST_F(DamagedModelFile, truncatedAnywhere)
{
  for (const std::size_t length : {std::size_t{9}, HEADER_SIZE - 1})
    expectWords(loadingError(good_.substr(0, length)), {"truncated within its header"});
  for (std::size_t length = HEADER_SIZE; length < good_.size(); length += 1 + good_.size() / 40)
    expectWords(loadingError(good_.substr(0, length)), {"truncated"});
  expectWords(loadingError(good_.substr(0, good_.size() - 1)), {"truncated"});
  expectWords(loadingError(good_ + "x"), {"longer than it says"});
}

TEST_F(DamagedModelFile, anyFlippedBit)
{
  for (std::size_t i = 0; i < 200; ++i)
  {
    // Every bit of the header's hash and sizes, then bits all over the content.
    const std::size_t at = i < 2 * 8 ? 16 + i : HEADER_SIZE + (i * 7919) % (good_.size() - HEADER_SIZE);
    std::string damaged = good_;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << (i % 8)));
    const std::string message = loadingError(damaged);
    if (i >= 2 * 8)
    {
      expectWords(message, {"checksum"});
    }
  }
}

/// A payload that the checksum calls good, as a faulty writer or a mischief-maker would leave it.
std::string sealed(std::string file)
{
  const std::uint64_t hash = hashBytes(file.data() + HEADER_SIZE, file.size() - HEADER_SIZE);
  std::memcpy(&file[24], &hash, sizeof(hash));
  return file;
}

TEST_F(DamagedModelFile, absurdContentBehindAGoodChecksum)
{
  // The first size, that of the name, then any eight bytes: either the content stays sound, or it is refused. What must
  // not happen is a crash or an allocation beyond the file's size.
  std::string huge_name = good_;
  std::memset(&huge_name[HEADER_SIZE], 0xff, 8);
  expectWords(loadingError(sealed(huge_name)), {"does not fit together", "end early"});
  int refused = 0;
  for (std::size_t i = 0; i < 300; ++i)
  {
    std::string damaged = good_;
    std::memset(&damaged[HEADER_SIZE + (i * 7919) % (good_.size() - HEADER_SIZE - 8)], i % 2 == 0 ? 0xff : 0x7f, 8);
    try
    {
      loadModel(folder_.write("damaged", sealed(damaged)));
    }
    catch (const ModelFileError&)
    {
      ++refused;
    }
  }
  EXPECT_GT(refused, 50);
}

TEST_F(DamagedModelFile, cannotBeWritten)
{
  const std::string path = folder_.path("no_such_folder/model");
  expectWords(messageOf<FileError>([&] { saveModel(TrainedModel(), path); }), {path, "folder exists"});
  std::filesystem::create_directory(folder_.path("folder"));
  expectWords(messageOf<FileError>([&] { saveModel(TrainedModel(), folder_.path("folder")); }), {"cannot write"});
  EXPECT_FALSE(std::filesystem::exists(folder_.path("folder.tmp")));
}

}  // namespace
}  // namespace bin_picking
