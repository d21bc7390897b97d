// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/grasp_reach.hpp"

#include <gtest/gtest.h>

namespace bin_picking
{
namespace
{
Kinematics ur5e() { return Kinematics(loadRobot(std::string(BIN_PICKING_SOURCE_DIR) + "/config/robots/ur5e.yaml")); }

/// A camera over the bin, looking down and a little askew.
Pose cameraInBase()
{
  Pose pose = Pose::Identity();
  pose.linear() = (Eigen::AngleAxisd(M_PI, Eigen::Vector3d(1, 0.2, 0).normalized()) *
                   Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()))
                      .toRotationMatrix();
  pose.translation() = Eigen::Vector3d(-0.5, 0.05, 0.9);
  return pose;
}

/// Straight down at a place in the frame `base`, 80 mm in and 100 mm out.
Grasp graspAt(const Eigen::Vector3d& flange_base)
{
  Pose T_base_tool0 = Pose::Identity();
  T_base_tool0.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  T_base_tool0.translation() = flange_base;
  const Pose T_camera_base = cameraInBase().inverse();
  Grasp grasp;
  grasp.T_camera_tool0_grasp = T_camera_base * T_base_tool0;
  grasp.T_camera_tool0_pre_grasp = T_camera_base * Eigen::Translation3d(0, 0, 0.08) * T_base_tool0;
  grasp.T_camera_tool0_retreat = T_camera_base * Eigen::Translation3d(0, 0, 0.10) * T_base_tool0;
  return grasp;
}

TEST(GraspReach, jointsTakeTheFlangeThere)
{
  const Kinematics arm = ur5e();
  Grasp grasp = graspAt({-0.5, 0.1, 0.3});
  checkReach(grasp, arm, cameraInBase(), ReachParameters());
  EXPECT_TRUE(grasp.reach_checked);
  EXPECT_EQ(grasp.rejection, GraspRejection::None);
  EXPECT_TRUE(grasp.reason.empty());
  ASSERT_EQ(grasp.joints.size(), 3u);
  const Pose* const poses[] = {&grasp.T_camera_tool0_pre_grasp, &grasp.T_camera_tool0_grasp,
                               &grasp.T_camera_tool0_retreat};
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_TRUE(arm.forward(grasp.joints[i]).isApprox(cameraInBase() * *poses[i], 1e-6)) << i;
}

TEST(GraspReach, whatIsTooFarIsRejectedWithTheReason)
{
  Grasp grasp = graspAt({-1.5, 0.1, 0.3});
  checkReach(grasp, ur5e(), cameraInBase(), ReachParameters());
  EXPECT_TRUE(grasp.reach_checked);
  EXPECT_EQ(grasp.rejection, GraspRejection::OutOfReach);
  EXPECT_FALSE(grasp.reason.empty());
  EXPECT_TRUE(grasp.joints.empty());
}

TEST(GraspReach, aStretchedArmIsSingular)
{
  // An elbow of 0.05 rad: nearly stretched.
  const Kinematics arm = ur5e();
  Joints joints;
  joints << 0, -0.9, 0.05, -0.8, -1.4, 0;
  Grasp grasp;
  grasp.T_camera_tool0_grasp = cameraInBase().inverse() * arm.forward(joints);
  grasp.T_camera_tool0_pre_grasp = grasp.T_camera_tool0_retreat = grasp.T_camera_tool0_grasp;
  checkReach(grasp, arm, cameraInBase(), ReachParameters());
  EXPECT_EQ(grasp.rejection, GraspRejection::Singular) << grasp.reason;
}
}  // namespace
}  // namespace bin_picking
