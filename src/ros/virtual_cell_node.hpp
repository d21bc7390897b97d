// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <bin_picking_perception/Grip.h>
#include <bin_picking_perception/TakePart.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <std_srvs/Trigger.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "frame_lookup.hpp"
#include "pickable_cell.hpp"
#include "virtual_cell_parameters.hpp"
#include "virtual_cell_publisher.hpp"

namespace bin_picking_ros
{
/// A bin with a 3D sensor over it, in simulation: to the perception what the driver of the sensor is, to tests the
/// truth, and to a picking program a hand that takes parts away. Threads: the first filling has one of its own;
/// exposures and services have a queue with two, so that one of them tells what the other is busy with; the caller's
/// queue gets nothing.
class VirtualCellNode
{
public:
  /// Returns at once. Wrong parameters or files do not throw: the node stays, and its services tell what is wrong.
  VirtualCellNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);
  /// Ends a filling, waits for an exposure or a settling pile, joins all threads.
  ~VirtualCellNode();
  VirtualCellNode(const VirtualCellNode&) = delete;
  VirtualCellNode& operator=(const VirtualCellNode&) = delete;

private:
  using Trigger = std_srvs::Trigger;
  using TakePart = bin_picking_perception::TakePart;
  using Grip = bin_picking_perception::Grip;

  enum class State
  {
    Filling,
    Ready,
    Failed
  };
  struct Status
  {
    State state = State::Filling;
    std::string text = "The parts are being read.";  ///< one sentence
  };

  bool readParameters(const ros::NodeHandle& private_nh);
  void startServices(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh);

  /// From any thread, but by one at a time: who changes the state to Filling.
  void fill();
  void showProgress(double share, int& logged_quarters);
  void setStatus(State state, const std::string& text);
  Status status() const;
  /// \throws RequestError NOT_READY while the bin is filled, INTERNAL where that failed
  void requireReady() const;

  /// What the work on the cell gives; without physics, the cell has failed. \throws as the work
  template <typename Work>
  auto act(const Work& work);

  /// Publishes what the sensor sees. \pre cell_mutex_ is locked, the bin is filled \return what was published
  std::string expose();
  void exposePeriodically();

  bool handleTrigger(Trigger::Request& request, Trigger::Response& response);
  bool handleRefill(Trigger::Request& request, Trigger::Response& response);
  bool handleShake(Trigger::Request& request, Trigger::Response& response);
  bool handleTakePart(TakePart::Request& request, TakePart::Response& response);
  TakePart::Response takePart(const TakePart::Request& request);
  bool handleGrip(Grip::Request& request, Grip::Response& response);
  Grip::Response grip(const Grip::Request& request);
  bin_picking::Pose poseInCamera(const geometry_msgs::PoseStamped& pose) const;
  /// \pre cell_mutex_ is locked
  std::optional<int> partAt(const bin_picking::Pose& T_camera_object, const TakePart::Request& request) const;

  std::optional<VirtualCellParameters> parameters_;  ///< nothing where they are wrong
  FrameLookup frames_;
  std::atomic<bool> stop_{false};

  mutable std::mutex status_mutex_;
  Status status_;

  std::mutex cell_mutex_;  ///< guards the next two; never locked while somebody waits for tf
  std::optional<PickableCell> cell_;
  VirtualCellPublisher publisher_;

  ros::CallbackQueue queue_;
  ros::ServiceServer trigger_;
  ros::ServiceServer refill_;
  ros::ServiceServer shake_;
  ros::ServiceServer take_part_;
  ros::ServiceServer grip_;
  ros::WallTimer timer_;
  std::unique_ptr<ros::AsyncSpinner> spinner_;
  std::thread first_filling_;
};
}  // namespace bin_picking_ros
