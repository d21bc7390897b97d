// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "node_diagnostics.hpp"

#include <diagnostic_msgs/DiagnosticStatus.h>

#include <chrono>
#include <exception>

#include "cloud_conversion.hpp"
#include "cloud_wait.hpp"
#include "time_difference.hpp"

namespace bin_picking_ros
{
namespace
{
using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;

constexpr double MIN_VALID_SHARE = 0.2;    // less is unusual even for shiny parts in a deep bin
constexpr std::size_t SUMMARY_STRIDE = 8;  // 36 000 of 2.3 million points: far below a millisecond
}  // namespace

NodeDiagnostics::NodeDiagnostics(ros::NodeHandle nh, const ros::NodeHandle& private_nh, const CloudBuffer& clouds,
                                 const ModelLoader& loader, double max_depth, double max_silence)
    : clouds_(clouds),
      loader_(loader),
      max_depth_(max_depth),
      max_silence_(max_silence),
      time_before_(ros::WallTime::now()),
      updater_(nh, private_nh, private_nh.getNamespace())
{
  updater_.setHardwareID(nh.resolveName("points"));
  updater_.add("models", [this](DiagnosticStatusWrapper& status) { describeModels(status); });
  updater_.add("input cloud", [this](DiagnosticStatusWrapper& status) { describeInput(status); });
  updater_.add("last result", [this](DiagnosticStatusWrapper& status) { describeResult(status); });
  timer_ = nh.createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { updater_.force_update(); });
}

void NodeDiagnostics::note(const ReturnCode& code, const std::vector<bin_picking::StageTime>& timing,
                           double total_seconds)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  last_ = Outcome{code, timing, total_seconds};
}

void NodeDiagnostics::describeModels(DiagnosticStatusWrapper& status) const
{
  const ModelLoader::Status loader = loader_.status();
  switch (loader.state)
  {
    case ModelLoader::State::Loading:
      status.summary(DiagnosticStatus::WARN, loader.text);
      break;
    case ModelLoader::State::Ready:
      status.summary(DiagnosticStatus::OK, loader.text);
      break;
    case ModelLoader::State::Failed:
      status.summary(DiagnosticStatus::ERROR, loader.text);
      break;
  }
}

void NodeDiagnostics::describeInput(DiagnosticStatusWrapper& status)
{
  const ros::WallTime now = ros::WallTime::now();
  const std::uint64_t num_received = clouds_.numReceived();
  const double period = (now - time_before_).toSec();
  const double rate = period > 0 ? static_cast<double>(num_received - num_received_before_) / period : 0.0;
  const bool has_come = num_received > num_received_before_;
  num_received_before_ = num_received;
  time_before_ = now;

  const sensor_msgs::PointCloud2ConstPtr cloud = clouds_.latest();
  if (!cloud)
  {
    status.summary(DiagnosticStatus::WARN, "No cloud has come yet.");
    return;
  }
  status.add("rate [Hz]", rate);
  status.add("received", num_received);
  status.add("frame", cloud->header.frame_id);
  status.add("age [s]", secondsBetween(cloud->header.stamp, ros::Time::now()));
  status.add("size", std::to_string(cloud->width) + " x " + std::to_string(cloud->height));
  try
  {
    const CloudSummary summary = summarizeCloud(*cloud, SUMMARY_STRIDE);
    status.add("valid share", summary.validShare());
    status.add("median depth", summary.median_depth);
    if (summary.median_depth > max_depth_)
      status.summary(DiagnosticStatus::ERROR, "The cloud looks like millimetres; metres are wanted.");
    else if (cloud->height < 2)
      status.summary(DiagnosticStatus::ERROR, "The cloud is not organized.");
    else if (summary.validShare() < MIN_VALID_SHARE)
      status.summary(DiagnosticStatus::WARN, "Few points of the cloud are valid.");
    else
      describeArrival(has_come, status);
  }
  catch (...)
  {
    status.summary(DiagnosticStatus::ERROR, translateException(std::current_exception()).message);
  }
}

/// Of a cloud that is as it should be.
void NodeDiagnostics::describeArrival(bool has_come, DiagnosticStatusWrapper& status) const
{
  const double silence = std::chrono::duration<double>(CloudBuffer::Clock::now() - clouds_.lastReceived()).count();
  if (has_come)
    status.summary(DiagnosticStatus::OK, "Clouds come in.");
  else
    status.summary(silence > max_silence_ ? DiagnosticStatus::WARN : DiagnosticStatus::OK,
                   "The last cloud came " + secondsText(silence) + " ago.");
}

void NodeDiagnostics::describeResult(DiagnosticStatusWrapper& status)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  if (!last_)
  {
    status.summary(DiagnosticStatus::OK, "Nothing was asked yet.");
    return;
  }
  status.summary(last_->code.value < 0 ? DiagnosticStatus::WARN : DiagnosticStatus::OK,
                 last_->code.name + ": " + last_->code.message);
  status.add("total [s]", last_->total_seconds);
  for (const bin_picking::StageTime& time : last_->timing)
    status.add(time.stage + " [s]", time.seconds);
}
}  // namespace bin_picking_ros
