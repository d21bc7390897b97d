// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "bin_picking_perception/detector.hpp"
#include "cloud_buffer.hpp"
#include "model_loader.hpp"
#include "return_code.hpp"

namespace bin_picking_ros
{
/// What /diagnostics says about the detector: models, input cloud, last result and its timing. Once per second.
class NodeDiagnostics
{
public:
  /// The arguments must outlive it. \param max_depth median depth above which a cloud looks like millimetres, metres
  /// \param max_silence how long no cloud may come until it is a warning, seconds; infinite: clouds come on demand
  NodeDiagnostics(ros::NodeHandle nh, const ros::NodeHandle& private_nh, const CloudBuffer& clouds,
                  const ModelLoader& loader, double max_depth, double max_silence);

  /// Notes the outcome of a request. Thread-safe.
  void note(const ReturnCode& code, const std::vector<bin_picking::StageTime>& timing, double total_seconds);

private:
  struct Outcome
  {
    ReturnCode code;
    std::vector<bin_picking::StageTime> timing;
    double total_seconds = 0;
  };

  void describeModels(diagnostic_updater::DiagnosticStatusWrapper& status) const;
  void describeInput(diagnostic_updater::DiagnosticStatusWrapper& status);
  void describeArrival(bool has_come, diagnostic_updater::DiagnosticStatusWrapper& status) const;
  void describeResult(diagnostic_updater::DiagnosticStatusWrapper& status);

  const CloudBuffer& clouds_;
  const ModelLoader& loader_;
  double max_depth_;
  double max_silence_;
  std::uint64_t num_received_before_ = 0;
  ros::WallTime time_before_;
  std::mutex mutex_;
  std::optional<Outcome> last_;
  diagnostic_updater::Updater updater_;
  ros::WallTimer timer_;
};
}  // namespace bin_picking_ros
