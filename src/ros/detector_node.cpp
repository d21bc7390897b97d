// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "detector_node.hpp"

#include <ros/console.h>

#include <algorithm>
#include <chrono>
#include <sstream>
#include <utility>

#include "bin_picking_perception/common/error.hpp"
#include "part_loading.hpp"
#include "resource_path.hpp"
#include "time_difference.hpp"

namespace bin_picking_ros
{
namespace
{
using sensor_msgs::PointCloud2ConstPtr;

std::optional<bin_picking::Bin> loadOptionalBin(const std::string& file)
{
  if (file.empty())
    return std::nullopt;
  return bin_picking::loadBin(resolveResource(file));
}

void checkRequest(const bin_picking_perception::GetBestGrasp::Request& request)
{
  using Request = bin_picking_perception::GetBestGrasp::Request;
  if (request.acquisition != Request::WAIT_NEW && request.acquisition != Request::USE_LATEST)
    throw RequestError(ReturnCode::INVALID_ARGUMENT, "The acquisition is " + std::to_string(request.acquisition) +
                                                         "; it must be WAIT_NEW (0) or USE_LATEST (1).");
  if (request.max_age < ros::Duration(0) || request.deadline < ros::Duration(0))
    throw RequestError(ReturnCode::INVALID_ARGUMENT,
                       "max_age and deadline must not be negative; 0 means the parameter.");
}

std::string secondsText(double seconds)
{
  std::ostringstream text;
  text.precision(3);
  text << seconds << " s";
  return text.str();
}
}  // namespace

struct DetectorNode::Job
{
  explicit Job(double deadline_seconds) : deadline(deadline_seconds) {}

  double elapsed() const { return std::chrono::duration<double>(CloudBuffer::Clock::now() - start).count(); }

  ros::Time called = ros::Time::now();
  CloudBuffer::Clock::time_point start = CloudBuffer::Clock::now();
  double deadline;  ///< seconds from the start; 0: none
  PointCloud2ConstPtr cloud;
};

DetectorNode::DetectorNode(ros::NodeHandle nh, ros::NodeHandle private_nh)
    : parameters_(readNodeParameters(private_nh)),
      gripper_(bin_picking::loadGripper(resolveResource(parameters_.gripper))),
      bin_(loadOptionalBin(parameters_.bin)),
      parts_(loadParts(parameters_.parts)),
      nh_(nh),
      frames_(nh),
      publisher_(private_nh, parameters_.tf_prefix),
      tuned_(parameters_)
{
  const std::string cache =
      parameters_.model_cache.empty() ? rosHome() + "/bin_picking_models" : resolveResource(parameters_.model_cache);
  loader_ = std::make_unique<ModelLoader>(
      ModelLoader::Job{parts_, parameters_.training, cache, parameters_.detector.num_threads},
      [this](const ModelLoader::Models& models) { setModels(models); });
  diagnostics_ = std::make_unique<NodeDiagnostics>(nh_, private_nh, clouds_, *loader_,
                                                   parameters_.detector.input.max_plausible_depth);
  tuning_ = std::make_unique<Tuning>(private_nh, parameters_, [this](const NodeParameters& p) { retune(p); });
  cloud_subscriber_ = nh_.subscribe("points", 1, &CloudBuffer::store, &clouds_, ros::TransportHints().tcpNoDelay());
  startService(private_nh);
  if (parameters_.process == ProcessMode::Continuous)
    continuous_thread_ = std::thread([this] { processContinuously(); });
}

DetectorNode::~DetectorNode()
{
  cloud_subscriber_.shutdown();
  clouds_.close();
  frames_.close();
  service_.shutdown();
  service_spinner_->stop();
  if (continuous_thread_.joinable())
    continuous_thread_.join();
  tuning_.reset();
  diagnostics_.reset();
  loader_.reset();
}

void DetectorNode::startService(const ros::NodeHandle& private_nh)
{
  ros::NodeHandle service_nh(private_nh);
  service_nh.setCallbackQueue(&service_queue_);
  service_ = service_nh.advertiseService("get_best_grasp", &DetectorNode::handleRequest, this);
  service_spinner_ = std::make_unique<ros::AsyncSpinner>(1, &service_queue_);
  service_spinner_->start();
}

void DetectorNode::setModels(const ModelLoader::Models& models)
{
  publisher_.setMarkerMaker(std::make_shared<MarkerMaker>(models, gripper_));
  const std::lock_guard<std::mutex> lock(pipeline_mutex_);
  models_ = models;
  rebuildPipeline();
}

void DetectorNode::retune(const NodeParameters& parameters)
{
  const std::lock_guard<std::mutex> lock(pipeline_mutex_);
  tuned_ = parameters;
  if (!models_.empty())
    rebuildPipeline();
}

void DetectorNode::rebuildPipeline()
{
  pipeline_ =
      std::make_shared<PickPipeline>(PickPipeline::Setup{models_, parts_, gripper_, tuned_.detector, tuned_.grasping});
}

std::shared_ptr<const PickPipeline> DetectorNode::readyPipeline() const
{
  const std::lock_guard<std::mutex> lock(pipeline_mutex_);
  if (pipeline_)
    return pipeline_;
  const ModelLoader::Status loader = loader_->status();
  throw RequestError(loader.state == ModelLoader::State::Failed ? ReturnCode::INTERNAL : ReturnCode::NOT_READY,
                     loader.text);
}

bool DetectorNode::handleRequest(Request& request, Response& response)
{
  Job job(request.deadline > ros::Duration(0) ? request.deadline.toSec() : parameters_.deadline);
  try
  {
    response = answer(request, job);
  }
  catch (...)
  {
    response = fail(translateException(std::current_exception()), job);
  }
  if (job.cloud)
    response.age = durationBetween(job.cloud->header.stamp, ros::Time::now());
  return true;  // false would reach the caller without any data
}

DetectorNode::Response DetectorNode::answer(const Request& request, Job& job)
{
  checkRequest(request);
  const std::shared_ptr<const PickPipeline> pipeline = readyPipeline();
  pipeline->requireParts(request.part_ids);
  job.cloud = request.acquisition == Request::WAIT_NEW ? waitForNew(job) : takeLatest(request, job);
  const OutputFrame output =
      outputFrame(job.cloud->header, request.output_frame.empty() ? parameters_.output_frame : request.output_frame);

  PickRequest pick;
  pick.parts = request.part_ids;
  pick.max_grasps = request.max_grasps;
  pick.accept_undetermined_turn = request.accept_undetermined_turn;
  return toResponse(process(*pipeline, std::move(pick), output, job), output);
}

PointCloud2ConstPtr DetectorNode::waitForNew(const Job& job) const
{
  const double limit = job.deadline > 0 ? std::min(job.deadline, parameters_.cloud_timeout) : parameters_.cloud_timeout;
  const auto until =
      job.start + std::chrono::duration_cast<CloudBuffer::Clock::duration>(std::chrono::duration<double>(limit));
  if (PointCloud2ConstPtr cloud = clouds_.waitForStamp(job.called, until))
    return cloud;
  if (clouds_.closed())
    throw RequestError(ReturnCode::NOT_READY, "The node is shutting down.");
  const PointCloud2ConstPtr latest = clouds_.latest();
  if (!latest)
    throw RequestError(ReturnCode::NO_CLOUD, "No cloud has come on " + cloud_subscriber_.getTopic() + " yet; " +
                                                 secondsText(limit) + " were waited.");
  throw RequestError(ReturnCode::NO_CLOUD,
                     "No cloud exposed after the call came within " + secondsText(limit) + "; the newest is stamped " +
                         secondsText(secondsBetween(latest->header.stamp, job.called)) + " before the call.");
}

PointCloud2ConstPtr DetectorNode::takeLatest(const Request& request, const Job& job) const
{
  PointCloud2ConstPtr cloud = clouds_.latest();
  if (!cloud)
    throw RequestError(ReturnCode::NO_CLOUD, "No cloud has come on " + cloud_subscriber_.getTopic() + " yet.");
  if (cloud->header.stamp.isZero())
    throw RequestError(ReturnCode::STALE_CLOUD, "The newest cloud carries no time, so that its age is not known.");
  const double max_age = request.max_age > ros::Duration(0) ? request.max_age.toSec() : parameters_.max_age;
  const double age = secondsBetween(cloud->header.stamp, job.called);
  if (age > max_age)
    throw RequestError(ReturnCode::STALE_CLOUD, "The newest cloud is " + secondsText(age) + " old; at most " +
                                                    secondsText(max_age) + " are allowed.");
  return cloud;
}

OutputFrame DetectorNode::outputFrame(const std_msgs::Header& cloud_header, const std::string& frame) const
{
  if (cloud_header.frame_id.empty())
    throw RequestError(ReturnCode::BAD_CLOUD, "The cloud has no frame_id, so that nobody knows where its points are.");
  OutputFrame output;
  output.header.stamp = cloud_header.stamp;
  output.header.frame_id = frame.empty() ? cloud_header.frame_id : frame;
  output.T_output_camera =
      frames_.lookup(output.header.frame_id, cloud_header.frame_id, cloud_header.stamp, parameters_.tf_timeout);
  return output;
}

std::optional<bin_picking::Bin> DetectorNode::binAt(const std_msgs::Header& cloud_header) const
{
  std::optional<bin_picking::Bin> bin = bin_;
  if (bin && !parameters_.bin_frame.empty())
    bin->T_camera_bin =
        frames_.lookup(cloud_header.frame_id, parameters_.bin_frame, cloud_header.stamp, parameters_.tf_timeout);
  return bin;
}

PickResult DetectorNode::process(const PickPipeline& pipeline, PickRequest pick, const OutputFrame& output,
                                 const Job& job)
{
  pick.bin = binAt(job.cloud->header);
  pick.keep_segmentation = publisher_.wantsSegmentation();
  if (job.deadline > 0)
  {
    pick.deadline = job.deadline - job.elapsed();
    if (pick.deadline <= 0)
      throw RequestError(ReturnCode::DEADLINE,
                         "The deadline of " + secondsText(job.deadline) + " passed before the cloud was used.");
  }
  PickResult result = pipeline.run(*job.cloud, pick);
  publisher_.publish(result, output);
  diagnostics_->note(result.code, result.detection.timing, result.detection.total_seconds);
  return result;
}

DetectorNode::Response DetectorNode::fail(const ReturnCode& code, const Job& job)
{
  ROS_WARN_STREAM_THROTTLE(1.0, code.name << ": " << code.message << " " << code.hint);
  Response response;
  response.code = code;
  if (job.cloud)
  {
    response.header = job.cloud->header;
    publisher_.publishFailure(code, job.cloud->header);
  }
  diagnostics_->note(code, {}, job.elapsed());
  return response;
}

void DetectorNode::processContinuously()
{
  std::uint64_t num_seen = clouds_.numReceived();
  while (const PointCloud2ConstPtr cloud = clouds_.waitForNext(num_seen))
  {
    Job job(parameters_.deadline);
    job.cloud = cloud;
    try
    {
      const std::shared_ptr<const PickPipeline> pipeline = readyPipeline();
      process(*pipeline, PickRequest(), outputFrame(cloud->header, parameters_.output_frame), job);
    }
    catch (...)
    {
      fail(translateException(std::current_exception()), job);
    }
  }
}
}  // namespace bin_picking_ros
