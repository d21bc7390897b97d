// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <bin_picking_perception/Grip.h>
#include <bin_picking_perception/SceneTruth.h>
#include <bin_picking_perception/TakePart.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_srvs/Trigger.h>

#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "virtual_cell_node.hpp"

namespace bin_picking_ros
{
using bin_picking_perception::Grip;
using bin_picking_perception::SceneTruth;
using bin_picking_perception::TakePart;

const std::chrono::seconds CELL_PATIENCE(120);  // only reached when something is broken

/// Everything that carries the same stamp.
struct Exposure
{
  sensor_msgs::PointCloud2ConstPtr cloud;
  sensor_msgs::CameraInfoConstPtr camera_info;
  boost::shared_ptr<const SceneTruth> truth;

  bool complete() const { return cloud && camera_info && truth; }
};

/// Exposures put together by their stamps, in order.
class ExposureCollector
{
public:
  ExposureCollector(ros::NodeHandle nh, ros::NodeHandle private_nh)
  {
    cloud_ = nh.subscribe<sensor_msgs::PointCloud2>(
        "points", 10, [this](const auto& m) { store(m->header.stamp, [&](Exposure& e) { e.cloud = m; }); });
    camera_info_ = nh.subscribe<sensor_msgs::CameraInfo>(
        "camera_info", 10, [this](const auto& m) { store(m->header.stamp, [&](Exposure& e) { e.camera_info = m; }); });
    truth_ = private_nh.subscribe<SceneTruth>(
        "truth", 10, [this](const auto& m) { store(m->header.stamp, [&](Exposure& e) { e.truth = m; }); });
  }

  /// The first complete exposure stamped at or after a time.
  Exposure since(const ros::Time& earliest)
  {
    std::unique_lock<std::mutex> lock(mutex_);
    Exposure found;
    const auto is_there = [&] {
      for (auto entry = exposures_.lower_bound(earliest); entry != exposures_.end() && !found.complete(); ++entry)
        found = entry->second;
      return found.complete();
    };
    EXPECT_TRUE(changed_.wait_for(lock, CELL_PATIENCE, is_there)) << "no cloud with camera_info and truth came";
    return found;
  }

private:
  template <typename Assign>
  void store(const ros::Time& stamp, Assign assign)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    assign(exposures_[stamp]);
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::map<ros::Time, Exposure> exposures_;
  ros::Subscriber cloud_;
  ros::Subscriber camera_info_;
  ros::Subscriber truth_;
};

/// A small virtual cell in a namespace of its own, and whoever talks to it.
class CellUnderTest
{
public:
  /// \param parameters path below the private namespace -> text or number, over the small defaults
  explicit CellUnderTest(const std::string& name, const std::map<std::string, XmlRpc::XmlRpcValue>& parameters = {})
      : nh_(name), private_nh_(name + "/virtual_cell"), collector_(nh_, private_nh_)
  {
    private_nh_.setParam("parts", std::string(BIN_PICKING_SOURCE_DIR) + "/test/ros/step_block");
    private_nh_.setParam("counts", 5);
    private_nh_.setParam("sensor/width", 160);
    private_nh_.setParam("sensor/height", 128);
    private_nh_.setParam("bin_frame", "");
    for (const auto& [path, value] : parameters)
      private_nh_.setParam(path, value);
    node_ = std::make_unique<VirtualCellNode>(nh_, private_nh_);
  }

  std_srvs::Trigger::Response call(const std::string& service)
  {
    std_srvs::Trigger trigger;
    EXPECT_TRUE(ros::service::call(private_nh_.resolveName(service), trigger)) << "the call itself failed";
    EXPECT_FALSE(trigger.response.message.empty());
    return trigger.response;
  }

  TakePart::Response take(const TakePart::Request& request)
  {
    TakePart call;
    call.request = request;
    EXPECT_TRUE(ros::service::call(private_nh_.resolveName("take_part"), call)) << "the call itself failed";
    EXPECT_FALSE(call.response.message.empty());
    return call.response;
  }

  Grip::Response grip(const Grip::Request& request)
  {
    Grip call;
    call.request = request;
    EXPECT_TRUE(ros::service::call(private_nh_.resolveName("grip"), call)) << "the call itself failed";
    EXPECT_FALSE(call.response.what.empty());
    return call.response;
  }

  TakePart::Response takeId(int id)
  {
    TakePart::Request request;
    request.select = TakePart::Request::BY_ID;
    request.id = id;
    return take(request);
  }

  /// Triggers until the bin is full.
  Exposure expose()
  {
    const auto end = std::chrono::steady_clock::now() + CELL_PATIENCE;
    while (true)
    {
      const ros::Time before = ros::Time::now();
      const auto response = call("trigger");
      if (response.success)
        return collector_.since(before);
      if (std::chrono::steady_clock::now() > end)
      {
        ADD_FAILURE() << response.message;
        return {};
      }
    }
  }

  /// What the services say once the cell has given up.
  std::string failure()
  {
    const auto end = std::chrono::steady_clock::now() + CELL_PATIENCE;
    TakePart::Response response;
    do
      response = takeId(0);
    while (response.outcome == TakePart::Response::NOT_READY && std::chrono::steady_clock::now() < end);
    EXPECT_EQ(response.outcome, TakePart::Response::FAILED) << response.message;
    EXPECT_FALSE(call("trigger").success);
    return call("trigger").message;
  }

  ExposureCollector& collector() { return collector_; }
  void destroyNode() { node_.reset(); }

private:
  ros::NodeHandle nh_;
  ros::NodeHandle private_nh_;
  ExposureCollector collector_;
  std::unique_ptr<VirtualCellNode> node_;
};
}  // namespace bin_picking_ros
