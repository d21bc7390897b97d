// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "virtual_cell_node.hpp"

#include <ros/console.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

#include "cell_requests.hpp"
#include "grip_answer.hpp"
#include "pose_conversion.hpp"
#include "return_code.hpp"
#include "take_part_answer.hpp"

namespace bin_picking_ros
{
namespace
{
/// Ends a filling when the node goes.
struct Stopped
{
};

/// What the work answers, or what is to be said of the exception that ended it: none goes through a callback.
template <typename Work, typename Failed>
auto answered(const Work& work, const Failed& failed)
{
  try
  {
    return work();
  }
  catch (...)
  {
    return failed(translateException(std::current_exception()));
  }
}

/// The codes below 0 say that a request was not carried out.
void log(const char* service, int outcome, const std::string& text)
{
  if (outcome >= 0)
    ROS_INFO_STREAM(text);
  else
    ROS_WARN_STREAM_THROTTLE(1.0, service << ": " << text);
}
}  // namespace

VirtualCellNode::VirtualCellNode(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
    : frames_(nh), publisher_(nh, private_nh)
{
  const bool is_readable = readParameters(private_nh);
  startServices(nh, private_nh);
  if (is_readable)
    first_filling_ = std::thread([this] { fill(); });
}

VirtualCellNode::~VirtualCellNode()
{
  stop_ = true;
  frames_.close();
  timer_.stop();
  trigger_.shutdown();
  refill_.shutdown();
  shake_.shutdown();
  take_part_.shutdown();
  grip_.shutdown();
  spinner_->stop();
  if (first_filling_.joinable())
    first_filling_.join();
}

bool VirtualCellNode::readParameters(const ros::NodeHandle& private_nh)
{
  try
  {
    parameters_ = readVirtualCellParameters(private_nh);
    return true;
  }
  catch (const std::exception& error)
  {
    setStatus(State::Failed, error.what());
    return false;
  }
}

void VirtualCellNode::startServices(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh)
{
  ros::NodeHandle service_nh(private_nh);
  service_nh.setCallbackQueue(&queue_);
  trigger_ = service_nh.advertiseService("trigger", &VirtualCellNode::handleTrigger, this);
  refill_ = service_nh.advertiseService("refill", &VirtualCellNode::handleRefill, this);
  shake_ = service_nh.advertiseService("shake", &VirtualCellNode::handleShake, this);
  take_part_ = service_nh.advertiseService("take_part", &VirtualCellNode::handleTakePart, this);
  grip_ = service_nh.advertiseService("grip", &VirtualCellNode::handleGrip, this);
  ros::NodeHandle timer_nh(nh);
  timer_nh.setCallbackQueue(&queue_);
  if (parameters_ && parameters_->rate > 0)
    timer_ = timer_nh.createWallTimer(ros::WallDuration(1.0 / parameters_->rate),
                                      [this](const ros::WallTimerEvent&) { exposePeriodically(); });
  spinner_ = std::make_unique<ros::AsyncSpinner>(2, &queue_);
  spinner_->start();
}

void VirtualCellNode::fill()
{
  const auto start = std::chrono::steady_clock::now();
  const std::lock_guard<std::mutex> lock(cell_mutex_);
  try
  {
    if (!cell_)
      cell_.emplace(*parameters_);
    int logged_quarters = 0;
    cell_->refill([&](double share) { showProgress(share, logged_quarters); });
    if (!parameters_->bin_frame.empty())
      publisher_.sendBinFrame(cell_->cell().bin(), parameters_->frame_id, parameters_->bin_frame);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::ostringstream text;
    text.precision(3);
    text << "The bin of seed " << cell_->fillingSeed() << " holds " << partsText(cell_->numLeft())
         << "; filling it took " << seconds.count() << " s.";
    setStatus(State::Ready, text.str());
  }
  catch (const Stopped&)
  {}
  catch (const std::exception& error)
  {
    setStatus(State::Failed, error.what());
  }
}

void VirtualCellNode::showProgress(double share, int& logged_quarters)
{
  if (stop_)
    throw Stopped();
  const std::string text = "The bin is being filled: " + std::to_string(std::lround(100 * share)) + " % done.";
  const int quarters = static_cast<int>(4 * share);
  if (quarters > logged_quarters && quarters < 4)
  {
    ROS_INFO_STREAM(text);
    logged_quarters = quarters;
  }
  setStatus(State::Filling, text);
}

void VirtualCellNode::setStatus(State state, const std::string& text)
{
  if (state == State::Failed)
    ROS_ERROR_STREAM("The virtual cell publishes nothing. " << text);
  else if (state == State::Ready)
    ROS_INFO_STREAM(text);
  const std::lock_guard<std::mutex> lock(status_mutex_);
  status_ = {state, text};
}

VirtualCellNode::Status VirtualCellNode::status() const
{
  const std::lock_guard<std::mutex> lock(status_mutex_);
  return status_;
}

void VirtualCellNode::requireReady() const
{
  const Status now = status();
  if (now.state != State::Ready)
    throw RequestError(now.state == State::Filling ? ReturnCode::NOT_READY : ReturnCode::INTERNAL, now.text);
}

template <typename Work>
auto VirtualCellNode::act(const Work& work)
{
  try
  {
    return work();
  }
  catch (const PhysicsFailure& failure)
  {
    setStatus(State::Failed, failure.what());
    throw;
  }
}

std::string VirtualCellNode::expose()
{
  std_msgs::Header header;
  header.frame_id = parameters_->frame_id;
  header.stamp = ros::Time::now();  // before the exposure: nothing moves from here on
  const bin_picking::simulation::CellScan scan = cell_->expose();
  publisher_.publish(scan, cell_->cell().parts(), header);
  const std::vector<float>& z = scan.scan.grid.z;
  const auto num_valid = std::count_if(z.begin(), z.end(), [](float depth) { return !std::isnan(depth); });
  return "Published a cloud with " + std::to_string(num_valid) + " of " + std::to_string(z.size()) +
         " points measured; " + partsText(scan.instances.size()) + " in the bin.";
}

void VirtualCellNode::exposePeriodically()
{
  const std::unique_lock<std::mutex> lock(cell_mutex_, std::try_to_lock);
  if (!lock || status().state != State::Ready || !publisher_.hasSubscribers())
    return;  // busy: the next tick comes soon
  try
  {
    expose();
  }
  catch (const std::exception& error)
  {
    ROS_ERROR_STREAM_THROTTLE(10.0, "The exposure failed. " << error.what());
  }
}

bool VirtualCellNode::handleTrigger(Trigger::Request&, Trigger::Response& response)
{
  try
  {
    requireReady();
    const std::lock_guard<std::mutex> lock(cell_mutex_);
    requireReady();  // a refill may have been first
    response.message = expose();
    response.success = 1;
  }
  catch (const std::exception& error)
  {
    response.success = 0;
    response.message = error.what();
  }
  return true;
}

bool VirtualCellNode::handleRefill(Trigger::Request&, Trigger::Response& response)
{
  response.success = 0;
  {
    const std::lock_guard<std::mutex> lock(status_mutex_);
    if (status_.state == State::Filling || !parameters_)
    {
      response.message = status_.text;
      return true;
    }
    status_ = {State::Filling, "The bin is being emptied."};
  }
  fill();
  const Status after = status();
  response.success = static_cast<std::uint8_t>(after.state == State::Ready);
  response.message = after.text;
  return true;
}

bool VirtualCellNode::handleShake(Trigger::Request&, Trigger::Response& response)
{
  response.success = 0;
  try
  {
    requireReady();
    const std::lock_guard<std::mutex> lock(cell_mutex_);
    requireReady();  // a refill may have been first
    if (cell_->numLeft() > 0)
      act([this] { cell_->shake(); });
    response.message = "Shaken: " + partsText(cell_->numLeft()) + " in the bin fell anew.";
    response.success = 1;
  }
  catch (const std::exception& error)
  {
    response.message = error.what();
  }
  return true;
}

bool VirtualCellNode::handleTakePart(TakePart::Request& request, TakePart::Response& response)
{
  response = answered([&] { return takePart(request); }, failedAnswer);
  log("take_part", response.outcome, response.message);
  return true;  // false would reach the caller without any data
}

VirtualCellNode::TakePart::Response VirtualCellNode::takePart(const TakePart::Request& request)
{
  requireReady();
  checkRequest(request);
  std::optional<bin_picking::Pose> T_camera_object;
  if (request.select == TakePart::Request::BY_POSE)
    T_camera_object = poseInCamera(request.pose);  // may wait: before the lock
  const std::lock_guard<std::mutex> lock(cell_mutex_);
  requireReady();  // a refill may have been first
  const std::optional<int> id = T_camera_object ? partAt(*T_camera_object, request) : request.id;
  if (!id)
    return nothingThere(request, cell_->numLeft());
  return toAnswer(act([&] { return cell_->take(*id); }), *id);
}

bool VirtualCellNode::handleGrip(Grip::Request& request, Grip::Response& response)
{
  response = answered([&] { return grip(request); }, failedGrip);
  log("grip", response.outcome, response.what);
  return true;  // false would reach the caller without any data
}

VirtualCellNode::Grip::Response VirtualCellNode::grip(const Grip::Request& request)
{
  requireReady();
  checkRequest(request);
  const bin_picking::Pose T_camera_pre_grasp = poseInCamera(request.pre_grasp);  // may wait: before the lock
  const bin_picking::Pose T_camera_grasp = poseInCamera(request.grasp);
  const bin_picking::Pose T_camera_retreat = poseInCamera(request.retreat);
  std::optional<bin_picking::Pose> T_camera_meant;
  if (!request.part_pose.header.frame_id.empty())
    T_camera_meant = poseInCamera(request.part_pose);
  const std::lock_guard<std::mutex> lock(cell_mutex_);
  requireReady();  // a refill may have been first
  const bin_picking::Pose T_bin_camera = cell_->cell().bin().T_camera_bin.inverse();
  const bin_picking::simulation::GripPath path{T_bin_camera * T_camera_pre_grasp, T_bin_camera * T_camera_grasp,
                                               T_bin_camera * T_camera_retreat, request.opening, request.width};
  if (!request.part.empty() && !cell_->hasPart(request.part))
    throw RequestError(ReturnCode::INVALID_ARGUMENT,
                       "The cell has no part named " + request.part + "; its parts are those of the parameter parts.");
  std::optional<int> meant;
  if (T_camera_meant)
    meant = cell_->partAt(*T_camera_meant, request.part, parameters_->tolerance);
  return toAnswer(act([&] { return cell_->grip(path); }), meant);
}

bin_picking::Pose VirtualCellNode::poseInCamera(const geometry_msgs::PoseStamped& pose) const
{
  if (pose.header.frame_id.empty())
    throw RequestError(ReturnCode::INVALID_ARGUMENT,
                       "The pose has no frame_id; the camera's frame is " + parameters_->frame_id + ".");
  return frames_.lookup(parameters_->frame_id, pose.header.frame_id, pose.header.stamp, parameters_->tf_timeout) *
         fromMessage(pose.pose);
}

std::optional<int> VirtualCellNode::partAt(const bin_picking::Pose& T_camera_object,
                                           const TakePart::Request& request) const
{
  if (!request.part.empty() && !cell_->hasPart(request.part))
    throw RequestError(ReturnCode::INVALID_ARGUMENT,
                       "The cell has no part named " + request.part + "; its parts are those of the parameter parts.");
  return cell_->partAt(T_camera_object, request.part,
                       request.tolerance > 0 ? request.tolerance : parameters_->tolerance);
}
}  // namespace bin_picking_ros
