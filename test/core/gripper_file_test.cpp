// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <algorithm>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/grasping/gripper.hpp"
#include "temporary_folder.hpp"

namespace bin_picking
{
namespace
{
using test::expectWords;
using test::messageOf;
using test::TemporaryFolder;

TEST(GripperFile, readsBoxes)
{
  const TemporaryFolder folder;
  const Gripper gripper =
      loadGripper(folder.write("gripper.yaml",
                               "name: two fingers\nmax_opening: 95mm\nboxes:\n"
                               "  - {name: left, center: [0, 0.01, -0.03], size: [0.02, 0.02, 0.06], finger: 1}\n"
                               "  - {name: palm, center: [0, 0, -0.1], size: [0.08, 0.1, 0.08]}\n"));
  EXPECT_EQ(gripper.name, "two fingers");
  EXPECT_NEAR(gripper.max_opening, 0.095, 1e-12);
  ASSERT_EQ(gripper.boxes.size(), 2u);
  EXPECT_EQ(gripper.boxes[0].name, "left");
  EXPECT_EQ(gripper.boxes[0].finger, 1);
  EXPECT_EQ(gripper.boxes[0].center, Eigen::Vector3d(0, 0.01, -0.03));
  EXPECT_EQ(gripper.boxes[1].size, Eigen::Vector3d(0.08, 0.1, 0.08));
  EXPECT_EQ(gripper.boxes[1].finger, 0);
}

TEST(GripperFile, namesWhatIsWrong)
{
  const TemporaryFolder folder;
  const auto error = [&](const std::string& content) {
    const std::string path = folder.write("gripper.yaml", content);
    return messageOf<FileError>([&] { loadGripper(path); });
  };
  const std::string head = "name: g\nmax_opening: 0.1\n";
  const std::string box = "boxes: [{name: palm, center: [0, 0, 0], size: [1, 1, 1]}]\n";
  expectWords(messageOf<FileError>([&] { loadGripper(folder.path("missing.yaml")); }), {"missing.yaml"});
  expectWords(error(head), {"'boxes' is missing"});
  expectWords(error(head + "boxes: []\n"), {"gripper.yaml:3", "no 'boxes'"});
  expectWords(error("name: g\nmax_opening: 0\n" + box), {"gripper.yaml:2", "positive"});
  expectWords(error("name: g\nmax_openning: 0.1\n" + box), {"gripper.yaml:2", "did you mean 'max_opening'?"});
  expectWords(error(head + "boxes: [{name: palm, center: [0, 0, 0], size: [1, 0, 1]}]\n"),
              {"gripper.yaml:3", "'palm'"});
  expectWords(error(head + "boxes: [{name: palm, center: [0, 0, 0], size: [1, 1, 1], finger: 2}]\n"),
              {"gripper.yaml:3", "'finger'", "is 2"});
  expectWords(error(head + "boxes: [{name: palm, centre: [0, 0, 0], size: [1, 1, 1]}]\n"), {"did you mean 'center'?"});
}

TEST(GripperFile, ag95IsSymmetricAndLeavesTheGapFree)
{
  const Gripper gripper = loadGripper(std::string(BIN_PICKING_SOURCE_DIR) + "/config/grippers/ag95.yaml");
  EXPECT_NEAR(gripper.max_opening, 0.095, 1e-12);
  for (const GripperBox& box : gripper.boxes)
  {
    // What moves must not reach between the fingers, where the part is, and has its mirror image.
    EXPECT_GE(box.finger * box.center.y() - box.size.y() / 2, box.finger == 0 ? -1 : -1e-12) << box.name;
    const Eigen::Vector3d mirrored(box.center.x(), -box.center.y(), box.center.z());
    EXPECT_TRUE(std::any_of(gripper.boxes.begin(), gripper.boxes.end(), [&](const GripperBox& other) {
      return other.finger == -box.finger && (other.center - mirrored).norm() < 1e-12 && other.size == box.size;
    })) << box.name;
  }
}
}  // namespace
}  // namespace bin_picking
