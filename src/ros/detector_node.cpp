// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "detector_node.hpp"

#include <ros/console.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "bin_picking_perception/common/error.hpp"
#include "cloud_wait.hpp"
#include "grasp_names.hpp"
#include "part_loading.hpp"
#include "resource_path.hpp"
#include "time_difference.hpp"

namespace bin_picking_ros
{
namespace
{
using sensor_msgs::PointCloud2ConstPtr;

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

std::optional<bin_picking::Robot> loadOptionalRobot(const std::string& file)
{
  if (file.empty())
    return std::nullopt;
  return bin_picking::loadRobot(resolveResource(file));
}

/// Where clouds are exposed on demand, none comes as long as nobody asks.
double maxSilence(const NodeParameters& parameters)
{
  return parameters.process == ProcessMode::Continuous ? parameters.cloud_timeout
                                                       : std::numeric_limits<double>::infinity();
}
}  // namespace

struct DetectorNode::Job
{
  Job(const CloudBuffer& clouds, double deadline_seconds) : num_seen(clouds.numReceived()), deadline(deadline_seconds)
  {}

  /// Every cloud comes in here, whoever asked for it. \throws RequestError STALE_CLOUD: its stamp is not credible
  void take(PointCloud2ConstPtr taken)
  {
    cloud = std::move(taken);
    requireCredibleStamp(cloud->header.stamp, ros::Time::now());
  }

  double elapsed() const { return std::chrono::duration<double>(CloudBuffer::Clock::now() - start).count(); }

  /// Seconds until the deadline.
  double left() const
  {
    return deadline > 0 ? std::max(0.0, deadline - elapsed()) : std::numeric_limits<double>::infinity();
  }

  ros::Time called = ros::Time::now();
  CloudBuffer::Clock::time_point start = CloudBuffer::Clock::now();
  std::uint64_t num_seen;  ///< clouds that had come by then
  double deadline;         ///< seconds from the start; 0: none
  PointCloud2ConstPtr cloud;
  bool is_for_all = false;     ///< nobody has asked: the topics are what it is done for
  bool has_own_frame = false;  ///< of the answer

  /// Whether an answer to anybody would have failed by this, so that no older result may stand on the topics.
  bool isFaultForAll(const ReturnCode& code) const
  {
    switch (code.value)
    {
      case ReturnCode::BAD_CLOUD:
      case ReturnCode::UNIT_SUSPECT:
      case ReturnCode::STALE_CLOUD:  // with a cloud that was taken: its stamp, not the wishes of the request
        return true;
      case ReturnCode::TF_UNKNOWN_FRAME:
      case ReturnCode::TF_DISCONNECTED:
      case ReturnCode::BAD_TRANSFORM:
        return is_for_all || (!has_own_frame && left() > 0);  // a deadline cuts the waiting for tf
      default:
        return is_for_all;
    }
  }
};

DetectorNode::DetectorNode(ros::NodeHandle nh, ros::NodeHandle private_nh)
    : parameters_(readNodeParameters(private_nh)),
      grippers_(GripperSet::load(parameters_.gripper, parameters_.grippers)),
      robot_(loadOptionalRobot(parameters_.robot)),
      parts_(loadParts(parameters_.parts)),
      nh_(nh),
      frames_(nh, parameters_, robot_),
      memory_(parameters_.avoid, static_cast<std::size_t>(parameters_.remembered_answers), runName()),
      publisher_(private_nh, parameters_.tf_prefix),
      tuned_(parameters_)
{
  const std::string cache =
      parameters_.model_cache.empty() ? rosHome() + "/bin_picking_models" : resolveResource(parameters_.model_cache);
  loader_ = std::make_unique<ModelLoader>(
      ModelLoader::Job{parts_, parameters_.training, cache, parameters_.detector.num_threads},
      [this](const ModelLoader::Models& models) { setModels(models); });
  diagnostics_ = std::make_unique<NodeDiagnostics>(
      nh_, private_nh, clouds_, *loader_, parameters_.detector.input.max_plausible_depth, maxSilence(parameters_));
  tuning_ = std::make_unique<Tuning>(private_nh, parameters_, [this](const NodeParameters& p) { retune(p); });
  cloud_subscriber_ = nh_.subscribe("points", 1, &CloudBuffer::store, &clouds_, ros::TransportHints().tcpNoDelay());
  reports_ = std::make_unique<ReportServices>(private_nh, memory_);
  startService(private_nh);
  if (parameters_.process == ProcessMode::Continuous)
    continuous_thread_ = std::thread([this] { processContinuously(); });
}

DetectorNode::~DetectorNode()
{
  cloud_subscriber_.shutdown();
  clouds_.close();
  frames_.close();
  turns_.close();
  service_spinner_->stop();  // before the service goes, and with it the connections: who waited is told why
  service_.shutdown();
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
  service_spinner_ = std::make_unique<ros::AsyncSpinner>(SERVICE_THREADS, &service_queue_);
  service_spinner_->start();
}

void DetectorNode::setModels(const ModelLoader::Models& models)
{
  publisher_.setMarkerMaker(std::make_shared<MarkerMaker>(models, grippers_));
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
  pipeline_ = std::make_shared<PickPipeline>(
      PickPipeline::Setup{models_, parts_, grippers_, tuned_.detector, tuned_.grasping, robot_});
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
  Job job(clouds_, request.deadline > ros::Duration(0) ? request.deadline.toSec() : parameters_.deadline);
  job.has_own_frame = !request.output_frame.empty();
  try
  {
    response = answer(request, job);
  }
  catch (...)
  {
    response = fail(translateException(std::current_exception()), job);
  }
  if (job.cloud && !job.cloud->header.stamp.isZero())
    response.age = durationBetween(job.cloud->header.stamp, ros::Time::now());
  return true;  // false would reach the caller without any data
}

DetectorNode::Response DetectorNode::answer(const Request& request, Job& job)
{
  checkRequest(request);
  grippers_.find(request.gripper);
  const std::shared_ptr<const PickPipeline> pipeline = readyPipeline();
  pipeline->requireParts(request.part_ids);
  job.take(acquire(request, job));
  const OutputFrame output = frames_.output(job.cloud->header, request.output_frame, job.left());

  PickRequest pick;
  pick.parts = request.part_ids;
  pick.max_grasps = request.max_grasps;
  pick.accept_undetermined_turn = request.accept_undetermined_turn;
  pick.gripper = request.gripper;
  pick.skip_collision = request.skip_collision;
  pick.skip_reach = request.skip_reach;
  return toResponse(process(*pipeline, std::move(pick), output, job, PickMemory::Channel::Service), output,
                    request.list_rejected);
}

PointCloud2ConstPtr DetectorNode::acquire(const Request& request, const Job& job) const
{
  CloudWish wish{job.called, job.start, job.num_seen, 0, cloud_subscriber_.getTopic()};
  if (request.acquisition == Request::WAIT_NEW)
  {
    wish.seconds = job.deadline > 0 ? std::min(job.deadline, parameters_.cloud_timeout) : parameters_.cloud_timeout;
    return waitForNew(clouds_, wish);
  }
  wish.seconds = request.max_age > ros::Duration(0) ? request.max_age.toSec() : parameters_.max_age;
  return takeLatest(clouds_, wish);
}

Turns::Turn DetectorNode::waitForTurn(const Job& job)
{
  auto until = job.start + std::chrono::hours(24 * 365);  // time_point::max() overflows in older standard libraries
  if (job.deadline > 0)
    until = job.start + std::chrono::duration_cast<Turns::Clock::duration>(std::chrono::duration<double>(job.deadline));
  Turns::Turn turn = turns_.wait(until);
  if (!turn && clouds_.closed())
    throw RequestError(ReturnCode::NOT_READY, "The node is shutting down.");
  if (!turn)
    throw RequestError(ReturnCode::DEADLINE,
                       "The deadline of " + secondsText(job.deadline) + " passed before the cloud was used.");
  return turn;
}

PickResult DetectorNode::process(const PickPipeline& pipeline, PickRequest pick, const OutputFrame& output,
                                 const Job& job, PickMemory::Channel channel)
{
  pick.bin = frames_.bin(job.cloud->header, job.left());
  pick.T_base_camera = frames_.robotBase(job.cloud->header, job.left());
  const bin_picking::Pose T_fixed_camera = CellFrames::fixedFrame(pick.bin, pick.T_base_camera);
  const Turns::Turn turn = waitForTurn(job);
  pick.keep_segmentation = publisher_.wantsSegmentation();
  if (job.deadline > 0)
    pick.deadline = std::max(job.left(), 1e-9);  // 0 would be none
  pick.avoided = avoidQuery(memory_, T_fixed_camera);
  PickResult result = pipeline.run(*job.cloud, pick);
  result.avoided = placesInCamera(memory_, T_fixed_camera);
  memory_.remember(nameGrasps(result, memory_.nextAnswer(), T_fixed_camera), channel);
  // Nothing that is ready by one's own deadline is no news for others.
  if (job.is_for_all || result.code.value != ReturnCode::DEADLINE)
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
    if (job.isFaultForAll(code))
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
    Job job(clouds_, parameters_.deadline);
    job.is_for_all = true;
    try
    {
      job.take(cloud);
      const std::shared_ptr<const PickPipeline> pipeline = readyPipeline();
      process(*pipeline, PickRequest(), frames_.output(cloud->header, "", job.left()), job, PickMemory::Channel::Topic);
    }
    catch (...)
    {
      fail(translateException(std::current_exception()), job);
    }
  }
}
}  // namespace bin_picking_ros
