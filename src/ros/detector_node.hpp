// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <bin_picking_perception/GetBestGrasp.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "cell_frames.hpp"
#include "cloud_buffer.hpp"
#include "gripper_set.hpp"
#include "model_loader.hpp"
#include "node_diagnostics.hpp"
#include "node_parameters.hpp"
#include "pick_memory.hpp"
#include "pick_pipeline.hpp"
#include "report_services.hpp"
#include "result_publisher.hpp"
#include "tuning.hpp"
#include "turns.hpp"

namespace bin_picking_ros
{
/// The detector as a ROS node: clouds in, service answers, topics and tf out. The constructor returns at once; models
/// are loaded in the background. Threads: the caller's queue takes clouds, timers and reconfiguration and never waits;
/// requests for grasps have a queue of their own with SERVICE_THREADS; so have reports, and continuous processing.
///
/// Requests wait for their cloud and for tf side by side. They are computed one after the other, in the order in which
/// their clouds were there: a detection already uses all processors, two at once would both be late.
class DetectorNode
{
public:
  static constexpr unsigned SERVICE_THREADS = 4;

  /// \throws bin_picking::Error if a parameter, part.yaml, bin, gripper or robot file is wrong
  DetectorNode(ros::NodeHandle nh, ros::NodeHandle private_nh);
  /// Ends waiting requests and joins all threads.
  ~DetectorNode();
  DetectorNode(const DetectorNode&) = delete;
  DetectorNode& operator=(const DetectorNode&) = delete;

private:
  using Request = bin_picking_perception::GetBestGrasp::Request;
  using Response = bin_picking_perception::GetBestGrasp::Response;

  /// One request on its way, so that also a failure knows its cloud and the time spent.
  struct Job;

  void startService(const ros::NodeHandle& private_nh);
  void setModels(const ModelLoader::Models& models);
  void retune(const NodeParameters& parameters);
  void rebuildPipeline();
  std::shared_ptr<const PickPipeline> readyPipeline() const;

  bool handleRequest(Request& request, Response& response);
  Response answer(const Request& request, Job& job);
  sensor_msgs::PointCloud2ConstPtr acquire(const Request& request, const Job& job) const;
  PickResult process(const PickPipeline& pipeline, PickRequest pick, const OutputFrame& output, const Job& job,
                     PickMemory::Channel channel);
  Turns::Turn waitForTurn(const Job& job);
  void processContinuously();
  Response fail(const ReturnCode& code, const Job& job);

  const NodeParameters parameters_;
  const GripperSet grippers_;
  const std::optional<bin_picking::Robot> robot_;
  std::vector<bin_picking::PartDefinition> parts_;
  ros::NodeHandle nh_;

  CloudBuffer clouds_;
  CellFrames frames_;
  PickMemory memory_;
  ResultPublisher publisher_;
  Turns turns_;
  mutable std::mutex pipeline_mutex_;  ///< guards the next three
  NodeParameters tuned_;               ///< parameters_ with what dynamic_reconfigure changed
  ModelLoader::Models models_;         ///< empty until they are loaded
  std::shared_ptr<const PickPipeline> pipeline_;
  std::unique_ptr<ModelLoader> loader_;
  std::unique_ptr<NodeDiagnostics> diagnostics_;
  std::unique_ptr<Tuning> tuning_;

  ros::Subscriber cloud_subscriber_;
  ros::CallbackQueue service_queue_;
  ros::ServiceServer service_;
  std::unique_ptr<ros::AsyncSpinner> service_spinner_;
  std::unique_ptr<ReportServices> reports_;
  std::thread continuous_thread_;
};
}  // namespace bin_picking_ros
