// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "mesh_shapes.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using test::expectWords;
using test::messageOf;
using test::TemporaryFolder;

const std::vector<Eigen::Vector3f> CORNERS = {{10, 0, 0}, {0, 20, 0}, {0, 0, 30}, {-10, 0, 0}};

void append(std::string& file, double value, bool big_endian)
{
  const auto narrow = static_cast<float>(value);
  std::string bytes(reinterpret_cast<const char*>(&narrow), sizeof(narrow));
  if (big_endian)
    std::reverse(bytes.begin(), bytes.end());
  file += bytes;
}

/// Normals before the points, a colour between, a list before both: any order is allowed.
std::string binaryPoints(bool big_endian)
{
  std::string file = std::string("ply\nformat ") + (big_endian ? "binary_big_endian" : "binary_little_endian") +
                     " 1.0\ncomment x y z\nelement strip 1\nproperty list uchar uchar indices\nelement vertex 4\n"
                     "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\n"
                     "property float z\nproperty float y\nproperty float x\nend_header\n";
  file += std::string("\x02\x07\x07", 3);
  for (const auto& p : CORNERS)
  {
    for (const double n : {0.0, 0.0, -2.0})
      append(file, n, big_endian);
    file += 'r';
    for (const int k : {2, 1, 0})
      append(file, static_cast<double>(p[k]), big_endian);
  }
  return file;
}

std::string asciiPoints(const std::string& last_row)
{
  return "ply\r\nformat ascii 1.0\r\nelement vertex 5\r\nproperty float x\r\nproperty float y\r\nproperty double z\r\n"
         "property float nx\r\nproperty float ny\r\nproperty float nz\r\nelement face 0\r\n"
         "property list uchar int vertex_indices\r\nend_header\r\n"
         "10 0 0 0 0 -2\n0 20 0 0 0 -2\n0 0 30 0 0 -2\n-10 0 0 0 0 -2\n" +
         last_row;
}

void expectCorners(const OrientedPoints& points)
{
  ASSERT_EQ(points.size(), 4u);
  ASSERT_EQ(points.normals.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i)
  {
    EXPECT_LT((points.points[i] - 0.001f * CORNERS[i]).norm(), 1e-8f);
    EXPECT_EQ(points.normals[i], Eigen::Vector3f(0, 0, -1));
  }
}

TEST(PointModel, readsPropertiesInAnyOrderAndFormat)
{
  const TemporaryFolder folder;
  expectCorners(loadOrientedPoints(folder.write("little.ply", binaryPoints(false)), LengthUnit::Millimetre));
  expectCorners(loadOrientedPoints(folder.write("big.ply", binaryPoints(true)), LengthUnit::Millimetre));
}

TEST(PointModel, dropsPointsThatAreNotFiniteOrWithoutNormal)
{
  const TemporaryFolder folder;
  for (const char* row : {"nan 0 0 0 0 1\n", "1 1 inf 0 0 1\n", "1 1 1 0 0 0\n", "1 1 1 -nan 0 0\n"})
    expectCorners(loadOrientedPoints(folder.write("points.ply", asciiPoints(row)), LengthUnit::Millimetre));
}

TEST(PointModel, refusesWhatCannotBeRead)
{
  const TemporaryFolder folder;
  const auto error = [&](const std::string& content, LengthUnit unit = LengthUnit::Millimetre) {
    const std::string path = folder.write("points.ply", content);
    return messageOf<FileError>([&] { loadOrientedPoints(path, unit); });
  };
  expectWords(messageOf<FileError>([&] { loadOrientedPoints(folder.path("missing.ply"), LengthUnit::Metre); }),
              {"missing.ply"});
  expectWords(error("solid"), {"PLY header"});
  expectWords(error(test::asciiPly(test::box(10, 10, 10))), {"nx ny nz"});
  expectWords(error(asciiPoints("1 1 1 0 0")), {"row 5 of 5"});
  expectWords(error(asciiPoints("1 1 1 0 x 0\n")), {"row 5 of 5"});
  const std::string binary = binaryPoints(false);
  expectWords(error(binary.substr(0, binary.size() - 1)), {"row 4 of 4"});
  expectWords(error("ply\nformat binary_middle_endian 1.0\nend_header\n"), {"binary_middle_endian"});
  expectWords(error("ply\nformat ascii 1.0\nelement vertex many\nend_header\n"), {"element vertex many"});
  expectWords(error(binary, LengthUnit::Metre), {"'mm'"});
}

TEST(PointModel, doesNotBelieveCountsThatTheFileCannotHold)
{
  const TemporaryFolder folder;
  const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex 18446744073709551615\n";
  const std::string path =
      folder.write("endless.ply", header +
                                      "property float x\nproperty float y\nproperty float z\n"
                                      "property float nx\nproperty float ny\nproperty float nz\nend_header\n");
  expectWords(messageOf<FileError>([&] { loadOrientedPoints(path, LengthUnit::Metre); }), {"row 1 of"});
}

TEST(PointModel, isToldFromAMesh)
{
  const TemporaryFolder folder;
  EXPECT_TRUE(isPointModel(folder.write("points.ply", binaryPoints(false))));
  EXPECT_TRUE(isPointModel(folder.write("no_faces.PLY", asciiPoints("1 1 1 0 0 1\n"))));
  EXPECT_FALSE(isPointModel(folder.write("mesh.ply", test::asciiPly(test::box(10, 10, 10)))));
  EXPECT_FALSE(isPointModel(folder.write("mesh.stl", test::asciiStl(test::box(10, 10, 10)))));
  EXPECT_THROW(isPointModel(folder.path("missing.ply")), FileError);
}
}  // namespace
}  // namespace bin_picking
