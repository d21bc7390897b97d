// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using Eigen::Vector3d;
using test::expectWords;
using test::messageOf;
using test::TemporaryFolder;

constexpr double DEGREE = M_PI / 180;

std::string gripperPath(const std::string& name)
{
  return std::string(BIN_PICKING_SOURCE_DIR) + "/config/grippers/" + name + ".yaml";
}

double reach(const ConvexBody& body, const Vector3d& axis)
{
  double farthest = -1e9;
  for (const Vector3d& v : body.vertices)
    farthest = std::max(farthest, axis.dot(v));
  return farthest;
}

TEST(GripperFile, readsTipAndBodies)
{
  const TemporaryFolder folder;
  const Gripper gripper = loadGripper(folder.write(
      "gripper.yaml",
      "format: 1\nname: two fingers\nkind: fingers\nmin_opening: 5mm\nmax_opening: 95mm\n"
      "tool0_to_tip: {position_xy: [0.001, 0.002], rotation_z_deg: 90, height: [[0.005, 0.2], [0.095, 0.19]]}\n"
      "bodies:\n"
      "  - {name: palm, box: {center: [0, 0, 0.05], size: [0.08, 0.1, 0.1]}}\n"
      "  - name: left\n    box: {center: [0, 0.01, 0.15], size: [0.02, 0.02, 0.06]}\n    touches_part: true\n"
      "    moves: [{opening: 0.005, offset: [0, 0, 0]}, {opening: 0.095, offset: [0, 0.045, -0.01]}]\n"
      "  - name: bar\n    box: {center: [0, 0, 0.15], size: [0.02, 0.02, 0.1]}\n    pivot: [0, 0, 0.1]\n"
      "    moves: [{opening: 0.005}, {opening: 0.095, angle_deg: 90}]\n"));
  EXPECT_EQ(gripper.name, "two fingers");
  EXPECT_EQ(gripper.kind, Gripper::Kind::Fingers);
  EXPECT_NEAR(gripper.min_opening, 0.005, 1e-12);
  EXPECT_NEAR(gripper.max_opening, 0.095, 1e-12);
  // Half way: half way in each table.
  const Pose T_tool0_tip = gripper.T_tool0_tip(0.05);
  EXPECT_TRUE(T_tool0_tip.translation().isApprox(Vector3d(0.001, 0.002, 0.195), 1e-12));
  EXPECT_TRUE(T_tool0_tip.linear().col(1).isApprox(-Vector3d::UnitX(), 1e-12));  // the fingers close along -X
  ASSERT_EQ(gripper.bodies.size(), 3u);
  EXPECT_FALSE(gripper.bodies[0].touches_part);
  EXPECT_TRUE(gripper.bodies[1].touches_part);
  const ConvexBody left = gripper.bodyAt(1, 0.05);
  EXPECT_NEAR(reach(left, Vector3d::UnitY()), 0.02 + 0.0225, 1e-12);
  EXPECT_NEAR(reach(left, Vector3d::UnitZ()), 0.18 - 0.005, 1e-12);
  // The bar stands up from its pivot at the smallest opening and lies along -Y at the largest.
  EXPECT_NEAR(reach(gripper.bodyAt(2, 0.005), Vector3d::UnitZ()), 0.2, 1e-12);
  EXPECT_NEAR(reach(gripper.bodyAt(2, 0.095), Vector3d::UnitZ()), 0.11, 1e-12);
  EXPECT_NEAR(reach(gripper.bodyAt(2, 0.095), -Vector3d::UnitY()), 0.1, 1e-12);
  EXPECT_NEAR(reach(gripper.bodyAt(2, 0.05), -Vector3d::UnitY()), 0.11 * std::sin(45 * DEGREE), 1e-12);
  for (const double impossible : {0.004, 0.096, std::nan("")})
  {
    EXPECT_THROW(gripper.T_tool0_tip(impossible), ParameterError);
    EXPECT_THROW(gripper.bodyAt(0, impossible), ParameterError);
  }
  expectWords(messageOf<ParameterError>([&] { gripper.bodyAt(1, 0.1); }), {"two fingers", "100 mm", "5 to 95 mm"});
}

TEST(GripperFile, readsTheHullOfAMesh)
{
  const TemporaryFolder folder;
  folder.write(
      "wedge.obj",
      "v 0 0 0\nv 20 0 0\nv 0 30 0\nv 0 0 40\nv 5 5 5\nf 1 3 2\nf 1 2 4\nf 2 5 4\nf 2 3 5\nf 3 4 5\nf 1 4 3\n");
  const std::string head = "format: 1\nname: g\nkind: suction\ntool0_to_tip: {height: [[0, 0.1]]}\n";
  const Gripper gripper = loadGripper(
      folder.write("g.yaml", head + "bodies: [{name: w, mesh: {file: wedge.obj, unit: mm}, touches_part: true}]\n"));
  EXPECT_EQ(gripper.kind, Gripper::Kind::Suction);
  EXPECT_EQ(gripper.max_opening, 0);
  const ConvexBody body = gripper.bodyAt(0, 0);
  EXPECT_EQ(body.vertices.size(), 4u);
  EXPECT_NEAR(reach(body, Vector3d::UnitZ()), 0.04, 1e-6);
  expectWords(messageOf<FileError>([&] {
                loadGripper(folder.write("g.yaml", head + "bodies: [{name: w, mesh: {file: wedge.obj, unit: furlong}, "
                                                          "touches_part: true}]\n"));
              }),
              {"g.yaml:5", "furlong"});
  expectWords(messageOf<FileError>([&] {
                loadGripper(folder.write("g.yaml", head + "bodies: [{name: w, mesh: {file: no.obj, unit: mm}}]\n"));
              }),
              {"g.yaml:5", "'w'", "no.obj"});
  folder.write("flat.obj", "v 0 0 0\nv 20 0 0\nv 0 30 0\nv 20 30 0\nf 1 2 3\nf 2 4 3\n");
  expectWords(messageOf<FileError>([&] {
                loadGripper(folder.write("g.yaml", head + "bodies: [{name: plate, touches_part: true,\n"
                                                          "  mesh: {file: flat.obj, unit: mm}}]\n"));
              }),
              {"g.yaml:6", "flat.obj", "'plate'", "flat"});
}

TEST(GripperFile, namesWhatIsWrong)
{
  const TemporaryFolder folder;
  const auto error = [&](const std::string& content) {
    const std::string path = folder.write("gripper.yaml", content);
    return messageOf<FileError>([&] { loadGripper(path); });
  };
  const std::string start = "format: 1\nname: g\nkind: fingers\n";
  const std::string head = start + "max_opening: 0.1\ntool0_to_tip: {height: [[0, 0.1]]}\n";
  const std::string box = "box: {center: [0, 0, 0], size: [1, 1, 1]}";
  const std::string bodies = "bodies: [{name: pad, " + box + ", touches_part: true}]\n";
  EXPECT_NO_THROW(loadGripper(folder.write("right.yaml", head + bodies)));
  expectWords(messageOf<FileError>([&] { loadGripper(folder.path("missing.yaml")); }), {"missing.yaml"});
  expectWords(error(head), {"'bodies' is missing"});
  expectWords(error(head + "bodies: []\n"), {"gripper.yaml:6", "no 'bodies'"});
  expectWords(error("format: 2\nname: g\n"), {"gripper.yaml:1", "'format' is 2"});
  expectWords(error("name: g\n"), {"'format' is missing"});
  expectWords(error("format: 1\nname: g\nkind: magnet\n"), {"gripper.yaml:3", "magnet", "'fingers' or 'suction'"});
  expectWords(error(start + "max_opening: 0\n"), {"gripper.yaml:4", "larger than 'min_opening'"});
  expectWords(error(start + "min_opening: -0.01\nmax_opening: 0.1\n"), {"gripper.yaml:4", "0 or more"});
  expectWords(error(start + "max_openning: 0.1\n" + bodies), {"gripper.yaml:4", "did you mean 'max_opening'?"});
  expectWords(error("format: 1\nname: g\nkind: suction\nmax_opening: 0.1\n"), {"gripper.yaml:4", "suction"});
  const std::string tip = start + "max_opening: 0.1\ntool0_to_tip: ";
  expectWords(error(tip + "{height: [[0, 0.1], [0.05, 0.1]]}\n"), {"gripper.yaml:5", "'height'", "0.05"});
  expectWords(error(tip + "{height: [[0, 0.1], [0.2, 0.1], [0.1, 0.1]]}\n"), {"gripper.yaml:5", "must rise"});
  expectWords(error(tip + "{height: [[0, 0.1, 0]]}\n"), {"gripper.yaml:5", "rows of 2 numbers"});
  expectWords(error(tip + "{height: []}\n"), {"gripper.yaml:5", "no rows"});
  expectWords(error(head + "bodies: [{name: palm, box: {center: [0, 0, 0], size: [1, 0, 1]}}]\n"),
              {"gripper.yaml:6", "'palm'", "positive"});
  expectWords(error(head + "bodies: [{name: palm, box: {centre: [0, 0, 0], size: [1, 1, 1]}}]\n"),
              {"did you mean 'center'?"});
  expectWords(error(head + "bodies: [{name: palm}]\n"), {"gripper.yaml:6", "either a 'box' or a 'mesh'"});
  expectWords(error(head + "bodies: [{name: palm, " + box + "}]\n"), {"gripper.yaml:6", "touches_part"});
  expectWords(error(head + "bodies: [{name: palm, " + box + ", moves: [{opening: 0}]}]\n"), {"at least two openings"});
  expectWords(error(head + "bodies: [{name: palm, " + box + ", moves: [{opening: 0}, {opening: 0.05}]}]\n"),
              {"'moves'", "smallest to the largest"});
}

/// The pads, inner faces towards each other, are one opening apart, and the tip lies between them.
/// \param beyond how far the fingers reach beyond the middle of their pads
void expectTipBetweenPads(const Gripper& gripper, double beyond)
{
  for (int step = 0; step <= 20; ++step)
  {
    const double opening = gripper.min_opening + step / 20.0 * (gripper.max_opening - gripper.min_opening);
    const Pose T_tip_tool0 = gripper.T_tool0_tip(opening).inverse();
    double left = 1;
    double right = 1;
    for (std::size_t i = 0; i < gripper.bodies.size(); ++i)
    {
      const ConvexBody body = transformed(gripper.bodyAt(i, opening), T_tip_tool0);
      const double low = -reach(body, -Vector3d::UnitY());
      const double high = reach(body, Vector3d::UnitY());
      const bool beside_pads = reach(body, Vector3d::UnitZ()) > -0.02;
      if (gripper.bodies[i].touches_part)
      {
        (low + high > 0 ? left : right) = low + high > 0 ? low : -high;
        EXPECT_NEAR(reach(body, Vector3d::UnitZ()), beyond, 1.5e-4) << "at " << opening;
      }
      else if (beside_pads)
      {
        EXPECT_TRUE(low > opening / 2 || high < -opening / 2) << gripper.bodies[i].name;
      }
    }
    EXPECT_NEAR(left, opening / 2, 1e-9);
    EXPECT_NEAR(right, opening / 2, 1e-9);
  }
}

/// Each body has its mirror image, or is its own, at every opening.
void expectMirrored(const Gripper& gripper)
{
  for (const double opening : {gripper.min_opening, 0.3 * gripper.max_opening, gripper.max_opening})
    for (std::size_t i = 0; i < gripper.bodies.size(); ++i)
    {
      const ConvexBody body = gripper.bodyAt(i, opening);
      bool found = false;
      for (std::size_t k = 0; k < gripper.bodies.size(); ++k)
      {
        const ConvexBody other = gripper.bodyAt(k, opening);
        found = found || std::all_of(body.vertices.begin(), body.vertices.end(), [&](const Vector3d& v) {
                  const Vector3d mirrored(v.x(), -v.y(), v.z());
                  return std::any_of(other.vertices.begin(), other.vertices.end(),
                                     [&](const Vector3d& w) { return (w - mirrored).norm() < 1e-9; });
                });
      }
      EXPECT_TRUE(found) << gripper.bodies[i].name << " at " << opening;
    }
}

TEST(GripperFile, fingersOfTheGrippersThatComeAlong)
{
  for (const char* const name : {"ag95", "parallel_80mm"})
  {
    const Gripper gripper = loadGripper(gripperPath(name));
    EXPECT_EQ(gripper.name, name);
    expectTipBetweenPads(gripper, gripper.name == "ag95" ? 0.006 : 0.008);
    expectMirrored(gripper);
  }
}

TEST(GripperFile, ag95FillsItsEnvelopeAndItsTipMovesOnAnArc)
{
  const Gripper gripper = loadGripper(gripperPath("ag95"));
  EXPECT_NEAR(gripper.max_opening, 0.095, 1e-12);
  Vector3d closed = Vector3d::Zero();
  Vector3d open = Vector3d::Zero();
  for (std::size_t i = 1; i < gripper.bodies.size(); ++i)  // without the coupling
    for (int axis = 0; axis < 3; ++axis)
    {
      closed[axis] = std::max(closed[axis], reach(gripper.bodyAt(i, 0), Vector3d::Unit(axis)));
      open[axis] = std::max(open[axis], reach(gripper.bodyAt(i, 0.095), Vector3d::Unit(axis)));
    }
  // Coupling of 14 mm and envelope of the data sheet: 184.6 mm long when closed, of which the slim fingertips leave out
  // 2 mm, 162.3 mm across when open, 67 mm thick.
  EXPECT_NEAR(closed.z(), 0.014 + 0.1846 - 0.002, 1e-9);
  EXPECT_NEAR(open.y(), 0.1623 / 2, 0.001);
  EXPECT_NEAR(open.x(), 0.067 / 2, 1e-9);
  // opening = 2 L (sin a + sin 10 deg), height = closed + L (cos a - cos 10 deg); the table is written to 0.1 mm.
  for (int degrees = -10; degrees <= 38; ++degrees)
  {
    const double opening = 2 * 0.06 * (std::sin(degrees * DEGREE) + std::sin(10 * DEGREE));
    const double height = 0.1906 + 0.06 * (std::cos(degrees * DEGREE) - std::cos(10 * DEGREE));
    EXPECT_NEAR(gripper.T_tool0_tip(opening).translation().z(), height, 2e-4) << degrees << " deg";
  }
}

TEST(GripperFile, suctionCupTouchesWithItsLipAtTheTip)
{
  const Gripper gripper = loadGripper(gripperPath("suction_cup_20mm"));
  EXPECT_EQ(gripper.kind, Gripper::Kind::Suction);
  for (std::size_t i = 0; i < gripper.bodies.size(); ++i)
  {
    const double front = reach(gripper.bodyAt(i, 0), Vector3d::UnitZ()) - gripper.T_tool0_tip(0).translation().z();
    if (gripper.bodies[i].touches_part)
    {
      EXPECT_NEAR(front, 0, 1e-9);
    }
    else
    {
      EXPECT_LT(front, -0.01) << gripper.bodies[i].name;
    }
  }
}
}  // namespace
}  // namespace bin_picking
