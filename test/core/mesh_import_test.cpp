// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

constexpr float SIDE = 40;  // millimetres, as drawn

void expectCube(const TriangleMesh& mesh)
{
  const MeshReport report = inspectMesh(mesh);
  EXPECT_EQ(mesh.vertices.size(), 8u);  // welded: STL repeats each corner for each triangle
  EXPECT_EQ(mesh.triangles.size(), 12u);
  // Single precision of 0.04 m is 4e-9 m.
  EXPECT_NEAR((report.size - Eigen::Vector3d::Constant(0.04)).norm(), 0, 1e-8);
  EXPECT_NEAR(report.area, 6 * 0.04 * 0.04, 1e-8);
  EXPECT_NEAR(report.volume, 0.04 * 0.04 * 0.04, 1e-10);
  EXPECT_NEAR(report.diameter, 0.04 * std::sqrt(3.0), 1e-8);
  EXPECT_EQ(report.open_edges, 0);
  EXPECT_EQ(report.degenerate_triangles, 0);
  EXPECT_TRUE(report.warnings.empty()) << report.warnings.front();
}

std::string loadingError(const std::string& path, LengthUnit unit = LengthUnit::Millimetre)
{
  return messageOf<FileError>([&] { loadMesh(path, unit); });
}

TEST(MeshImport, readsEveryFormat)
{
  const TemporaryFolder folder;
  const TriangleMesh cube = test::box(SIDE, SIDE, SIDE);
  expectCube(loadMesh(folder.write("ascii.stl", test::asciiStl(cube)), LengthUnit::Millimetre));
  expectCube(
      loadMesh(folder.write("binary.stl", test::binaryStl(cube, "exported by a CAD program")), LengthUnit::Millimetre));
  expectCube(loadMesh(folder.write("cube.ply", test::asciiPly(cube)), LengthUnit::Millimetre));
  expectCube(loadMesh(folder.write("cube.obj", test::obj(cube)), LengthUnit::Millimetre));
}

TEST(MeshImport, readsBinaryStlWhoseTitleLooksLikeAscii)
{
  const TemporaryFolder folder;
  const std::string file = test::binaryStl(test::box(SIDE, SIDE, SIDE), "solid Part_02");
  expectCube(loadMesh(folder.write("trap.stl", file), LengthUnit::Millimetre));
}

TEST(MeshImport, appliesTheStatedUnit)
{
  const TemporaryFolder folder;
  const std::string path = folder.write("cube.stl", test::binaryStl(test::box(1, 1, 1), ""));
  EXPECT_NEAR(inspectMesh(loadMesh(path, LengthUnit::Metre)).size.x(), 1, 1e-6);
  EXPECT_NEAR(inspectMesh(loadMesh(path, LengthUnit::Centimetre)).size.x(), 0.01, 1e-8);
  EXPECT_NEAR(inspectMesh(loadMesh(path, LengthUnit::Inch)).size.x(), 0.0254, 1e-8);
}

TEST(MeshImport, namesTheUnitThatWouldFit)
{
  const TemporaryFolder folder;
  const std::string millimetres = folder.write("mm.stl", test::binaryStl(test::box(SIDE, SIDE, SIDE), ""));
  expectWords(loadingError(millimetres, LengthUnit::Metre), {"mm.stl", "69.28 m", "2 m", "'mm' (69.28 mm)"});
  const std::string metres = folder.write("m.stl", test::binaryStl(test::box(0.04f, 0.04f, 0.04f), ""));
  expectWords(loadingError(metres), {"'m' (69.28 mm)"});
  const std::string hopeless = folder.write("km.stl", test::binaryStl(test::box(1e6f, 1e6f, 1e6f), ""));
  expectWords(loadingError(hopeless), {"no unit makes it fit"});
}

TEST(MeshImport, refusesWhatIsNoPart)
{
  const TemporaryFolder folder;
  expectWords(loadingError(folder.path("missing.stl")), {"missing.stl", "no such file"});
  expectWords(loadingError(folder.path(".")), {"folder"});
  expectWords(loadingError(folder.write("empty.stl", "")), {"empty.stl"});
  expectWords(loadingError(folder.write("text.stl", "no mesh at all")), {"text.stl", "STL, PLY and OBJ"});
  expectWords(loadingError(folder.write("none.ply", test::asciiPly({}))), {"none.ply"});
  expectWords(loadingError(folder.write("flat.stl", test::binaryStl(test::box(SIDE, SIDE, 0), ""))), {"flat"});
  TriangleMesh broken = test::box(SIDE, SIDE, SIDE);
  broken.vertices[3].y() = std::numeric_limits<float>::quiet_NaN();
  expectWords(loadingError(folder.write("nan.stl", test::binaryStl(broken, ""))), {"nan.stl", "not finite"});
  std::string truncated = test::binaryStl(test::box(SIDE, SIDE, SIDE), "title");
  truncated.resize(truncated.size() - 100);
  expectWords(loadingError(folder.write("truncated.stl", truncated)), {"truncated.stl"});
}

TEST(MeshImport, seesThatATiltedSheetIsFlat)
{
  TriangleMesh sheet = test::box(SIDE, SIDE, 0);
  const Eigen::AngleAxisf tilt(0.7f, Eigen::Vector3f(1, 2, 3).normalized());
  for (auto& vertex : sheet.vertices)
    vertex = tilt * vertex;
  const TemporaryFolder folder;
  expectWords(loadingError(folder.write("sheet.stl", test::binaryStl(sheet, ""))), {"flat"});
}

TEST(MeshImport, warnsOfHoles)
{
  TriangleMesh open = test::box(SIDE, SIDE, SIDE);
  open.triangles.pop_back();
  const TemporaryFolder folder;
  const MeshReport report =
      inspectMesh(loadMesh(folder.write("open.stl", test::binaryStl(open, "")), LengthUnit::Millimetre));
  EXPECT_EQ(report.open_edges, 3);
  ASSERT_EQ(report.warnings.size(), 1u);
  expectWords(report.warnings.front(), {"holes", "3 edges"});
}

TEST(MeshImport, turnsAnInsideOutMeshAndSaysSo)
{
  TriangleMesh inverted = test::box(SIDE, SIDE, SIDE);
  for (auto& t : inverted.triangles)
    std::swap(t[0], t[1]);
  EXPECT_LT(inspectMesh(inverted).volume, 0);
  const TemporaryFolder folder;
  const MeshReport report =
      inspectMesh(loadMesh(folder.write("inverted.stl", test::binaryStl(inverted, "")), LengthUnit::Millimetre));
  EXPECT_NEAR(report.volume, 0.04 * 0.04 * 0.04, 1e-10);
  ASSERT_EQ(report.warnings.size(), 1u);
  expectWords(report.warnings.front(), {"inside out"});
}

TEST(MeshImport, warnsOfNeighboursThatDisagree)
{
  TriangleMesh mixed = test::box(SIDE, SIDE, SIDE);
  std::swap(mixed.triangles[0][0], mixed.triangles[0][1]);
  const MeshReport report = inspectMesh(mixed);
  ASSERT_EQ(report.warnings.size(), 1u);
  expectWords(report.warnings.front(), {"disagree", "3 edges"});
}

TEST(MeshImport, dropsDegenerateTrianglesAndSaysSo)
{
  TriangleMesh mesh = test::box(SIDE, SIDE, SIDE);
  mesh.triangles.push_back({0, 0, 1});
  const TemporaryFolder folder;
  const TriangleMesh loaded = loadMesh(folder.write("line.stl", test::binaryStl(mesh, "")), LengthUnit::Millimetre);
  EXPECT_EQ(loaded.triangles.size(), 12u);
  const MeshReport report = inspectMesh(loaded);
  ASSERT_EQ(report.warnings.size(), 1u);
  expectWords(report.warnings.front(), {"1 degenerate"});
}

TEST(MeshImport, weldsCornersWrittenWithAnotherRounding)
{
  TriangleMesh mesh = test::box(SIDE, SIDE, SIDE);
  mesh.vertices.push_back(mesh.vertices[7] + Eigen::Vector3f(4e-6f, -4e-6f, 0));
  mesh.triangles[11][1] = 8;
  const TemporaryFolder folder;
  const TriangleMesh loaded = loadMesh(folder.write("rounded.ply", test::asciiPly(mesh)), LengthUnit::Millimetre);
  EXPECT_EQ(loaded.vertices.size(), 8u);
  EXPECT_EQ(inspectMesh(loaded).open_edges, 0);
}

TEST(MeshImport, measuresTheSphere)
{
  const MeshReport report = inspectMesh(test::sphereMesh(0.05f, 5));
  // 8192 triangles inscribed in the sphere: area and volume are short by less than 0.2 %.
  EXPECT_NEAR(report.area / (4 * M_PI * 0.05 * 0.05), 1, 0.002);
  EXPECT_NEAR(report.volume / (4 * M_PI / 3 * 0.05 * 0.05 * 0.05), 1, 0.002);
  EXPECT_NEAR(report.diameter, 0.1, 1e-6);
  EXPECT_EQ(report.open_edges, 0);
}

TEST(LargestDistance, isExactForABoxWithRoundedCorners)
{
  // Brute force is the oracle.
  TriangleMesh mesh = test::sphereMesh(0.01f, 3);
  for (auto& v : mesh.vertices)
    v += 0.03f * Eigen::Vector3f(v.x() > 0 ? 1.f : -1.f, v.y() > 0 ? 0.7f : -0.7f, v.z() > 0 ? 0.2f : -0.2f);
  double exact = 0;
  for (const auto& a : mesh.vertices)
    for (const auto& b : mesh.vertices)
      exact = std::max(exact, (a - b).cast<double>().norm());
  EXPECT_NEAR(largestDistance(mesh.vertices), exact, 1e-9);
  EXPECT_EQ(largestDistance({}), 0);
  EXPECT_EQ(largestDistance({Eigen::Vector3f(1, 2, 3)}), 0);
  EXPECT_EQ(largestDistance({Eigen::Vector3f(1, 2, 3), Eigen::Vector3f(1, 2, 3)}), 0);
}

TEST(LengthUnit, isReadByName)
{
  for (const LengthUnit unit : {LengthUnit::Metre, LengthUnit::Centimetre, LengthUnit::Millimetre, LengthUnit::Inch})
    EXPECT_EQ(parseLengthUnit(toString(unit)), unit);
  expectWords(messageOf<ParameterError>([] { parseLengthUnit("feet"); }), {"feet", "m, cm, mm, inch"});
}

TEST(Hash, matchesPublishedValues)
{
  // FNV-1a, 64 bit, from the authors' test vectors.
  EXPECT_EQ(hashBytes("", 0), 0xcbf29ce484222325ull);
  EXPECT_EQ(hashBytes("a", 1), 0xaf63dc4c8601ec8cull);
  EXPECT_EQ(hashBytes("foobar", 6), 0x85944171f73967e8ull);
  EXPECT_EQ(hashBytes("bar", 3, hashBytes("foo", 3)), hashBytes("foobar", 6));
  const TemporaryFolder folder;
  const std::string large(200000, 'x');
  EXPECT_EQ(hashFile(folder.write("large", large)), hashBytes(large.data(), large.size()));
  expectWords(messageOf<FileError>([&] { hashFile(folder.path("missing")); }), {"missing"});
}
}  // namespace
}  // namespace bin_picking
