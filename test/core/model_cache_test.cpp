// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "mesh_shapes.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using test::expectWords;
using test::TemporaryFolder;

PartDefinition boxPart(const TemporaryFolder& folder)
{
  PartDefinition part;
  part.name = "box";
  part.directory = folder.path("");
  part.mesh_file = folder.write("box.stl", test::binaryStl(test::box(60, 40, 20), ""));
  part.mesh_unit = LengthUnit::Millimetre;
  return part;
}

TEST(RequestHash, changesWithEverythingThatShapesTheModel)
{
  PartDefinition part;
  part.name = "a";
  TrainingParameters parameters;
  std::vector<std::uint64_t> hashes = {requestHash(part, parameters)};
  EXPECT_EQ(requestHash(part, parameters), hashes.front());
  part.training_yaml = "leaf: 0";  // as it is
  part.grasps.resize(1);           // not part of the model
  EXPECT_EQ(requestHash(part, parameters), hashes.front());

  parameters.seed = 2;
  hashes.push_back(requestHash(part, parameters));
  part.training_yaml = "leaf: 4mm";
  hashes.push_back(requestHash(part, parameters));
  part.mesh_unit = LengthUnit::Inch;
  hashes.push_back(requestHash(part, parameters));
  part.name = "b";
  hashes.push_back(requestHash(part, parameters));
  part.symmetry.discrete.emplace_back(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()));
  hashes.push_back(requestHash(part, parameters));
  part.symmetry.continuous = Symmetry::Axis{Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero()};
  hashes.push_back(requestHash(part, parameters));
  for (std::size_t i = 0; i < hashes.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      EXPECT_NE(hashes[i], hashes[k]) << i << ", " << k;
  part.training_yaml = "leef: 4mm";
  EXPECT_THROW(requestHash(part, parameters), ParameterError);
}

TEST(LoadOrTrain, trainsOnlyWhenItMustAndSaysWhy)
{
  const TemporaryFolder folder;
  PartDefinition part = boxPart(folder);
  TrainingParameters parameters;
  parameters.leaf = 0.008;
  parameters.num_views = 12;
  const std::string path = folder.path("box.bppm");
  std::string note;

  const auto trained = loadOrTrain(part, parameters, path, Executor(1), note);
  expectWords(note, {"'box'", "box.bppm", "does not exist yet"});
  const std::string bytes = test::readFile(path);
  const auto loaded = loadOrTrain(part, parameters, path, Executor(1), note);
  EXPECT_EQ(note, "");
  EXPECT_EQ(loaded->points.points, trained->points.points);
  EXPECT_EQ(loaded->table.numEntries(), trained->table.numEntries());

  parameters.num_views = 13;
  EXPECT_EQ(loadOrTrain(part, parameters, path, Executor(1), note)->views.size(), 13u);
  expectWords(note, {"training parameters"});
  folder.write("box.stl", test::binaryStl(test::box(60, 40, 25), ""));
  EXPECT_NEAR(loadOrTrain(part, parameters, path, Executor(1), note)->size.z(), 0.025, 1e-4);
  expectWords(note, {"another mesh", "box.stl"});
  folder.write("box.bppm", bytes.substr(0, bytes.size() / 2));
  EXPECT_EQ(loadOrTrain(part, parameters, path, Executor(1), note)->views.size(), 13u);
  expectWords(note, {"cannot be used", "truncated"});
  loadOrTrain(part, parameters, path, Executor(1), note);
  EXPECT_EQ(note, "");
}

TEST(LoadOrTrain, givesTheModelEvenIfItCannotBeKept)
{
  const TemporaryFolder folder;
  TrainingParameters parameters;
  parameters.leaf = 0.008;
  parameters.num_views = 12;
  std::string note;
  const auto model =
      loadOrTrain(boxPart(folder), parameters, folder.path("no_such_folder/box.bppm"), Executor(1), note);
  EXPECT_GT(model->table.numEntries(), 0u);
  expectWords(note, {"does not exist yet", "could not be kept", "no_such_folder"});
}
}  // namespace
}  // namespace bin_picking
