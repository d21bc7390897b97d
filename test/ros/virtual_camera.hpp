// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <ros/node_handle.h>
#include <sensor_msgs/PointCloud2.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "cloud_messages.hpp"

namespace test_clouds
{
/// 1 mm per pixel on the floor.
inline bin_picking::PinholeCamera blockCamera() { return {600, 600, 199.5, 149.5}; }

inline bin_picking::TriangleMesh floorMesh()
{
  bin_picking::TriangleMesh floor;
  floor.vertices = {{-0.3f, -0.3f, 0.6f}, {0.3f, -0.3f, 0.6f}, {0.3f, 0.3f, 0.6f}, {-0.3f, 0.3f, 0.6f}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  return floor;
}

/// The step block of this folder on the floor of its bin, 0.6 m below the camera, seen without noise.
struct BlockScene
{
  bin_picking::Pose T_camera_block = bin_picking::Pose::Identity();
  bin_picking::DepthGrid grid;
};

inline BlockScene renderBlock()
{
  BlockScene scene;
  // The bin's floor is z = 0.6; up is -z. The block lies flat on it, turned by 0.7 rad, beside the optical axis, so
  // that two of its sides are seen as well.
  scene.T_camera_block.linear() =
      (Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()) * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()))
          .toRotationMatrix();
  scene.T_camera_block.translation() = Eigen::Vector3d(0.05, -0.04, 0.6);
  const std::string mesh_file = std::string(BIN_PICKING_SOURCE_DIR) + "/test/ros/step_block/step_block.obj";
  const auto block = bin_picking::loadMesh(mesh_file, bin_picking::LengthUnit::Millimetre);
  bin_picking::DepthRenderer renderer(400, 300, blockCamera());
  renderer.draw(floorMesh(), bin_picking::Pose::Identity(), 0);
  renderer.draw(block, scene.T_camera_block, 1);
  scene.grid = renderer.grid();
  return scene;
}

/// The shaft of the demo parts across the view, 50 mm above the same floor, its keyway below: nobody can see it.
inline bin_picking::DepthGrid renderShaftFromBehind()
{
  bin_picking::Pose T_camera_shaft = bin_picking::Pose::Identity();
  T_camera_shaft.linear().col(0) = Eigen::Vector3d::UnitZ();  // the keyway's side, away from the camera
  T_camera_shaft.linear().col(2) = Eigen::Vector3d::UnitX();
  T_camera_shaft.linear().col(1) = T_camera_shaft.linear().col(2).cross(T_camera_shaft.linear().col(0));
  T_camera_shaft.translation() = Eigen::Vector3d(-0.06, 0, 0.55);
  const auto shaft =
      bin_picking::loadMesh(std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/stepped_shaft/stepped_shaft.stl",
                            bin_picking::LengthUnit::Millimetre);
  bin_picking::DepthRenderer renderer(400, 300, blockCamera());
  renderer.draw(floorMesh(), bin_picking::Pose::Identity(), 0);
  renderer.draw(shaft, T_camera_shaft, 1);
  return renderer.grid();
}

/// Publishes a cloud again and again, each time with the present time, until it is told to stop.
class VirtualCamera
{
public:
  VirtualCamera(ros::NodeHandle nh, const std::string& topic)
      : publisher_(nh.advertise<sensor_msgs::PointCloud2>(topic, 1))
  {}
  ~VirtualCamera() { stop(); }

  void start(const sensor_msgs::PointCloud2& cloud)
  {
    stop();
    running_ = true;
    thread_ = std::thread([this, cloud] { run(cloud); });
  }

  void stop()
  {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      running_ = false;
    }
    changed_.notify_all();
    if (thread_.joinable())
      thread_.join();
  }

private:
  void run(const sensor_msgs::PointCloud2& cloud)
  {
    std::unique_lock<std::mutex> lock(mutex_);
    while (running_)
    {
      const auto message = boost::make_shared<sensor_msgs::PointCloud2>(cloud);
      message->header.stamp = ros::Time::now();
      publisher_.publish(message);
      changed_.wait_for(lock, std::chrono::milliseconds(50), [this] { return !running_; });
    }
  }

  ros::Publisher publisher_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool running_ = false;
  std::thread thread_;
};
}  // namespace test_clouds
