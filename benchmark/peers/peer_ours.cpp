// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>

#include "bin_picking_perception/detector.hpp"
#include "peer_data.hpp"

namespace bin_picking::peers
{
namespace
{
class Ours : public Peer
{
public:
  explicit Ours(bool on_points) : on_points_(on_points) {}

  void train(const PeerModel& model, double step) override
  {
    TrainingParameters training;
    training.leaf = step * model.diameter;  // 0: derived from the part
    const auto trained = trainPart(model.definition, training, Executor(1));
    model_points_ = static_cast<int>(trained->points.size());
    DetectorParameters parameters = DetectorParameters::preset("fast");
    parameters.num_threads = 1;
    parameters.verification.accept_undetermined_turns = false;  // poses are held against the truth in full
    detector_ = std::make_unique<Detector>(std::vector<std::shared_ptr<const TrainedModel>>{trained}, parameters);
  }

  PeerResult find(const PeerScene& scene) override
  {
    const double start = cpuSeconds();
    const DetectionResult found = on_points_ ? detector_->match(scene.fine, false) : detect(scene);
    const double seconds = cpuSeconds() - start;
    PeerResult result;
    result.icp_seconds = seconds * refinementShare(found);
    result.match_seconds = seconds - result.icp_seconds;
    for (const Detection& detection : found.detections)
      result.poses.push_back({detection.T_camera_object, detection.score});
    for (const StageCount& count : found.counts)
      if (count.stage == "samples")
        result.scene_points = static_cast<int>(count.count);
    return result;
  }

  int modelPoints() const override { return model_points_; }
  bool verifies() const override { return true; }

private:
  DetectionResult detect(const PeerScene& scene) const
  {
    Detector::Request request;
    request.bin = scene.bin;
    return scene.cloud.empty() ? detector_->detect(scene.grid, request) : detector_->detect(scene.cloud, request);
  }

  /// Of the time, what comes after the poses are clustered.
  static double refinementShare(const DetectionResult& found)
  {
    const auto clustering = std::find_if(found.timing.begin(), found.timing.end(),
                                         [](const StageTime& time) { return time.stage == "clustering"; });
    if (clustering == found.timing.end())
      return 0;
    double seconds = 0;
    for (auto stage = clustering + 1; stage != found.timing.end(); ++stage)
      seconds += stage->seconds;
    return found.total_seconds > 0 ? seconds / found.total_seconds : 0;
  }

  bool on_points_;
  int model_points_ = 0;
  std::unique_ptr<Detector> detector_;
};
}  // namespace

std::unique_ptr<Peer> makeOurs() { return std::make_unique<Ours>(false); }
std::unique_ptr<Peer> makeOursOnPoints() { return std::make_unique<Ours>(true); }

const std::vector<PeerProgram>& programs()
{
  static const std::vector<PeerProgram> all = {{"ours", "ours", makeOurs, true},
                                               {"ours_on_points", "ours, points only", makeOursOnPoints, false},
                                               {"opencv", "OpenCV", makeOpenCv, false},
                                               {"pcl", "PCL", makePcl, false}};
  return all;
}
}  // namespace bin_picking::peers
