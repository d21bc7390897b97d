// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// The virtual cell: what a scan says is true of what lies in the bin.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "core/mesh_shapes.hpp"
#include "core/surface_distance.hpp"
#include "core/temporary_folder.hpp"
#include "virtual_cell.hpp"

using namespace bin_picking;
using namespace bin_picking::simulation;
using namespace bin_picking::test;

namespace
{
CellPart demoPart(const std::string& name)
{
  const PartDefinition part = loadPart(std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/" + name);
  return {part.name, std::make_shared<TriangleMesh>(loadMesh(part.mesh_file, part.mesh_unit))};
}

const CellPart& tee()
{
  static const CellPart part = demoPart("three_way_tube");
  return part;
}

CellPart block() { return {"block", std::make_shared<TriangleMesh>(test::box(0.06f, 0.04f, 0.025f))}; }

CellParameters smallCell(SensorClass type)
{
  CellParameters parameters;
  parameters.sensor = sensorDefaults(type);
  parameters.sensor.width = 400;
  parameters.sensor.height = 320;
  return parameters;
}

/// Pixels that carry each label; the last one: none.
std::vector<int> countLabels(const CellScan& scan)
{
  std::vector<int> counts(scan.instances.size() + 1, 0);
  for (const std::int32_t label : scan.scan.labels)
    ++counts[label < 0 ? scan.instances.size() : static_cast<std::size_t>(label)];
  return counts;
}

bool same(const std::vector<Body>& a, const std::vector<Body>& b)
{
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Body& one, const Body& other) {
    return one.shape == other.shape && one.T_bin_object.matrix() == other.T_bin_object.matrix();
  });
}

/// Bit for bit: what is not measured counts as equal.
bool same(const std::vector<float>& a, const std::vector<float>& b)
{
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](float one, float other) { return one == other || (std::isnan(one) && std::isnan(other)); });
}
}  // namespace

TEST(CellScan, labelledPointsLieOnThePartsAtTheirTruePoses)
{
  VirtualCell cell({tee(), block()}, smallCell(SensorClass::Ideal));
  cell.fill({6, 5}, 3);
  const CellScan scan = cell.scan(1);
  ASSERT_EQ(scan.instances.size(), 11u);
  std::vector<std::vector<Eigen::Vector3f>> points_object(11);
  for (std::size_t i = 0; i < scan.scan.labels.size(); i += 5)
  {
    const std::int32_t label = scan.scan.labels[i];
    if (label < 0)
      continue;
    const Pose T_object_camera = scan.instances[static_cast<std::size_t>(label)].T_camera_object.inverse();
    const Eigen::Vector3f p = scan.scan.grid.point(static_cast<int>(i));
    points_object[static_cast<std::size_t>(label)].push_back((T_object_camera * p.cast<double>()).cast<float>());
  }
  for (std::size_t k = 0; k < 11; ++k)
  {
    // Floats at a distance of 0.8 m, with room for steep faces.
    const TriangleMesh& mesh = *cell.parts()[static_cast<std::size_t>(scan.instances[k].part)].mesh;
    EXPECT_LT(largestSurfaceDistance(points_object[k], mesh), 1e-5) << k;
    EXPECT_EQ(countLabels(scan)[k], scan.instances[k].view.visible_pixels) << k;
    EXPECT_EQ(scan.instances[k].view.valid_pixels, scan.instances[k].view.visible_pixels)
        << "the ideal sensor sees all";
  }
}

TEST(CellScan, posesAreThoseOfTheBodies)
{
  VirtualCell cell({tee()}, smallCell(SensorClass::Ideal));
  cell.fill({5}, 1);
  const CellScan scan = cell.scan(1);
  const std::vector<Body> bodies = cell.bodies();
  for (std::size_t k = 0; k < bodies.size(); ++k)
  {
    EXPECT_EQ(scan.instances[k].id, bodies[k].id);
    EXPECT_TRUE(scan.instances[k].T_camera_object.isApprox(cell.bin().T_camera_bin * bodies[k].T_bin_object, 1e-12));
  }
  // The camera hangs 0.8 m away and looks at the middle of the floor.
  EXPECT_TRUE(cell.bin().T_camera_bin.translation().isApprox(Eigen::Vector3d(0, 0, 0.8)));
  EXPECT_NEAR(std::acos(-cell.bin().T_camera_bin.linear()(2, 2)), cell.parameters().layout.camera_tilt, 1e-9);
}

TEST(CellScan, lonePartIsWhollyVisibleAndPiledOnesAreNot)
{
  VirtualCell cell({tee()}, smallCell(SensorClass::Ideal));
  cell.fill({1}, 1);
  const CellScan alone = cell.scan(1);
  EXPECT_EQ(alone.instances.at(0).view.visible_fraction, 1);
  EXPECT_GT(alone.instances.at(0).view.visible_pixels, 500);

  cell.clear();
  cell.fill({25}, 1);
  const CellScan pile = cell.scan(1);
  int whole = 0;
  int covered = 0;
  for (const CellInstance& instance : pile.instances)
  {
    whole += instance.view.visible_fraction > 0.99;
    covered += instance.view.visible_fraction < 0.8;
    EXPECT_LE(instance.view.visible_fraction, 1);
  }
  EXPECT_GE(whole, 3);
  EXPECT_GE(covered, 3);
}

TEST(CellScan, emptyBinShowsItsFloorWallsAndTable)
{
  VirtualCell cell({tee()}, smallCell(SensorClass::Ideal));
  const CellScan scan = cell.scan(1);
  EXPECT_TRUE(scan.instances.empty());
  EXPECT_EQ(countLabels(scan)[0], static_cast<int>(scan.scan.labels.size()));
  const Pose T_bin_camera = cell.bin().T_camera_bin.inverse();
  int on_floor = 0;
  int on_rim = 0;
  int on_table = 0;
  for (std::size_t i = 0; i < scan.scan.grid.size(); ++i)
  {
    ASSERT_TRUE(scan.scan.grid.valid(static_cast<int>(i))) << "the table fills the picture";
    const Eigen::Vector3d p = T_bin_camera * scan.scan.grid.point(static_cast<int>(i)).cast<double>();
    on_floor += std::abs(p.z()) < 1e-5 && std::abs(p.x()) < 0.2 && std::abs(p.y()) < 0.15;
    on_rim += std::abs(p.z() - 0.15) < 1e-5 && (std::abs(p.x()) > 0.2 || std::abs(p.y()) > 0.15);
    on_table += std::abs(p.z() + 0.005) < 1e-5;
    ASSERT_GT(p.z(), -0.005 - 1e-5);
    ASSERT_LT(p.z(), 0.15 + 1e-5);
  }
  EXPECT_GT(on_floor, 5000);
  EXPECT_GT(on_rim, 300);
  EXPECT_GT(on_table, 5000);
}

TEST(CellScan, partsNeverOverlapByMoreThanAMillimetre)
{
  CellParameters parameters = smallCell(SensorClass::Ideal);
  VirtualCell cell({tee(), block()}, parameters);
  cell.fill({10, 10}, 4);
  EXPECT_LE(cell.deepestOverlap().depth, 0.001);
  EXPECT_GT(cell.deepestOverlap().depth, 0) << "parts at rest touch";
  ASSERT_TRUE(cell.dropAgain(cell.bodies()[0].id, 1));
  EXPECT_LE(cell.deepestOverlap().depth, 0.001);
  EXPECT_FALSE(cell.dropAgain(12345, 1));
}

TEST(CellScan, kindsAreMixedInTheNumbersAskedFor)
{
  VirtualCell cell({tee(), block()}, smallCell(SensorClass::Ideal));
  cell.fill({3, 5}, 2);
  std::vector<int> kinds;
  for (const Body& body : cell.bodies())
    kinds.push_back(body.shape);
  EXPECT_EQ(std::count(kinds.begin(), kinds.end(), 0), 3);
  EXPECT_EQ(std::count(kinds.begin(), kinds.end(), 1), 5);
  EXPECT_FALSE(std::is_sorted(kinds.begin(), kinds.end())) << "not one kind after the other";
  cell.fill({0, 2}, 3);
  EXPECT_EQ(cell.bodies().size(), 10u) << "on top of what is there";
  ASSERT_TRUE(cell.remove(cell.bodies()[0].id));
  EXPECT_EQ(cell.scan(1).instances.size(), 9u);
}

TEST(CellScan, refilledCellIsAsNew)
{
  const CellParameters parameters = smallCell(SensorClass::StructuredLight);
  VirtualCell used({tee()}, parameters, 1);
  used.fill({10}, 3);
  used.remove(used.bodies()[4].id);
  used.scan(5);
  used.clear();
  used.fill({8}, 9);
  VirtualCell fresh({tee()}, parameters, 3);
  fresh.fill({8}, 9);
  EXPECT_TRUE(same(used.bodies(), fresh.bodies()));
  const CellScan one = used.scan(11);
  const CellScan other = fresh.scan(11);
  EXPECT_TRUE(same(one.scan.grid.x, other.scan.grid.x));
  EXPECT_TRUE(same(one.scan.grid.z, other.scan.grid.z));
  EXPECT_EQ(one.scan.labels, other.scan.labels);
  EXPECT_FALSE(same(used.scan(12).scan.grid.z, one.scan.grid.z)) << "another exposure has other noise";
}

TEST(CellScan, nonsenseIsRefused)
{
  const CellParameters parameters = smallCell(SensorClass::Ideal);
  expectWords(messageOf<ParameterError>([&] { VirtualCell({}, parameters); }), {"at least one kind of part"});
  VirtualCell cell({tee(), block()}, parameters);
  for (const std::vector<int>& counts : {std::vector<int>{}, {1}, {1, 2, 3}, {0, 0}, {-1, 5}})
    expectWords(messageOf<ParameterError>([&] { cell.fill(counts, 1); }), {"count for each of the 2 kinds"});
  expectWords(messageOf<ParameterError>([&] { cell.fill({30, 31}, 1); }), {"would hold 61 parts", "60"});
  EXPECT_TRUE(cell.bodies().empty());

  CellParameters flat = parameters;
  flat.layout.bin_height = -0.1;
  expectWords(messageOf<ParameterError>([&] { VirtualCell({tee()}, flat); }), {"layout/bin_height", "-0.1"});
  CellParameters small = parameters;
  small.layout.bin_length = small.layout.bin_width = 0.06;
  expectWords(messageOf<ParameterError>([&] { VirtualCell({tee()}, small); }), {"'three_way_tube'", "too large"});
  auto open = std::make_shared<TriangleMesh>(*block().mesh);
  open->triangles.pop_back();
  expectWords(messageOf<ParameterError>([&] { VirtualCell({{"lid", open}}, parameters); }), {"'lid'", "not closed"});
}
