// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/scene/bin.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using test::expectWords;
using test::messageOf;
using test::TemporaryFolder;

TEST(BinFile, readsPoseAndSize)
{
  const TemporaryFolder folder;
  // A quarter turn about z takes the bin's long side x to the camera's y.
  const Bin bin = loadBin(folder.write("bin.yaml",
                                       "pose: {position: [0.1, -0.2, 850mm], orientation: [0, 0, 0.70711, 0.70711]}\n"
                                       "inner_size: [0.4, 0.3, 0.12]\nwall_thickness: 5mm\n"));
  EXPECT_LT((bin.T_camera_bin * Eigen::Vector3d(0.1, 0, 0) - Eigen::Vector3d(0.1, -0.1, 0.85)).norm(), 1e-12);
  EXPECT_NEAR(bin.T_camera_bin.linear().determinant(), 1, 1e-12);
  EXPECT_EQ(bin.inner_size, Eigen::Vector3d(0.4, 0.3, 0.12));
  EXPECT_NEAR(bin.wall_thickness, 0.005, 1e-12);
}

TEST(BinFile, namesWhatIsWrong)
{
  const TemporaryFolder folder;
  const auto error = [&](const std::string& content) {
    const std::string path = folder.write("bin.yaml", content);
    return messageOf<FileError>([&] { loadBin(path); });
  };
  const std::string pose = "pose: {position: [0, 0, 1], orientation: [0, 0, 0, 1]}\n";
  const std::string size = "inner_size: [0.4, 0.3, 0.12]\n";
  expectWords(messageOf<FileError>([&] { loadBin(folder.path("missing.yaml")); }), {"missing.yaml", "no such file"});
  expectWords(error(size), {"bin.yaml:1", "'pose' is missing"});
  expectWords(error(pose), {"bin.yaml:1", "'inner_size' is missing"});
  expectWords(error(pose + "iner_size: [0.4, 0.3, 0.12]\n"), {"bin.yaml:2", "did you mean 'inner_size'?"});
  expectWords(error(pose + "inner_size: [0.4, -0.3, 0.12]\n"), {"bin.yaml:2", "positive"});
  expectWords(error(pose + size + "wall_thickness: 0\n"), {"bin.yaml:3", "positive"});
  expectWords(error("pose: {position: [0, 0, 1], orientation: [0, 0, 0, 1.002]}\n" + size),
              {"bin.yaml:1", "1.002", "w last"});
  expectWords(error("pose: {position: [0, 0, 1], orientation: [0, 0, 1]}\n" + size), {"bin.yaml:1", "4 numbers"});
  expectWords(error("pose: {position: [0, 0, 1], rotation: [0, 0, 0, 1]}\n" + size), {"bin.yaml:1", "'rotation'"});
}

TEST(BinFile, exampleIsReadable)
{
  const Bin bin = loadBin(std::string(BIN_PICKING_SOURCE_DIR) + "/config/bins/example.yaml");
  // Seen from above: the bin's z points at the camera.
  EXPECT_LT(bin.T_camera_bin.linear()(2, 2), -0.99);
  EXPECT_GE(bin.inner_size.x(), bin.inner_size.y());
}
}  // namespace
}  // namespace bin_picking
