// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/detector_parameters.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "bin_picking_perception/model/undetermined_turn.hpp"
#include "bin_picking_perception/refinement/confidence.hpp"
#include "bin_picking_perception/scene/bin.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace pcl
{
struct PointXYZ;
template <typename PointT>
class PointCloud;
}  // namespace pcl

namespace bin_picking
{
class KdTree;

/// A value together with the threshold it was held against.
struct Criterion
{
  std::string name;
  double value = 0;
  double required = 0;
  bool upper_limit = false;  ///< true: value must not exceed required

  bool passed() const { return upper_limit ? value <= required : value >= required; }
};

/// One instance of a part in the scene, or a pose that was considered and rejected.
struct Detection
{
  std::string part;
  std::size_t model_index = 0;  ///< into Detector::models()
  Pose T_camera_object = Pose::Identity();
  double score = 0;                 ///< [0, 1], the sort key: confidence(), or the matching rate where that decides
  double matching_rate = 0;         ///< Equation 9, [0, 1]
  double visible_fraction = 0;      ///< share of the surface facing the camera that was measured there, [0, 1]
  double rms = 0;                   ///< of the point-to-plane residuals after refinement, metres
  double votes = 0;                 ///< of its cluster
  std::vector<Criterion> criteria;  ///< tests that were made, with their thresholds
  std::string rejection;            ///< empty: accepted; else one sentence
  /// What the view leaves open of the pose, and its score does not count; nothing: the pose is known in full.
  std::optional<UndeterminedTurn> undetermined_turn;
  /// What the score was computed from; none without verification, and none for a pose that was given up early, whose
  /// score is 0.
  std::optional<PoseQuality> quality;
};

enum class DetectionCode
{
  Ok = 0,    ///< at least one detection
  BinEmpty,  ///< almost nothing is measured inside the limits but the bin's walls, and enough of its floor
  NoMatch,   ///< something is there, nothing was recognised
  BinUnseen  ///< almost nothing is measured inside the limits, and too little of the floor to call the bin empty
};

struct StageTime
{
  std::string stage;
  double seconds = 0;
};

struct StageCount
{
  std::string stage;
  double count = 0;
};

/// Pictures of what segmentation did, for people; only made on request. 8-bit, row-major, size of the working grid.
struct SegmentationView
{
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> gray;        ///< depth mapped to gray (Section 2.2.1)
  std::vector<std::int32_t> labels;      ///< 0 none, else segment number
  std::vector<std::int32_t> candidates;  ///< the same, candidate targets only
};

struct DetectionResult
{
  DetectionCode code = DetectionCode::NoMatch;
  std::string message;                ///< one sentence with numbers
  bool partial = false;               ///< the deadline passed: what was ready is returned
  std::vector<Detection> detections;  ///< accepted, best first
  std::vector<Detection> rejected;    ///< with their reasons, best first, at most DetectorParameters::max_rejected
  /// In order of the pipeline. Segmentation runs beside what describes the surface, if there are threads for both: its
  /// time is what was left to wait for.
  std::vector<StageTime> timing;
  double total_seconds = 0;  ///< cloud in memory -> ranked detections
  std::vector<StageCount> counts;
  std::optional<SegmentationView> segmentation;
  /// What was measured, floor and walls included, at the finest resolution that a part was searched with: what a
  /// gripper may touch.
  std::shared_ptr<const DepthGrid> surroundings;
};

/// The online phase. Thread-safe: detect() may be called from several threads.
class Detector
{
public:
  /// \param models at least one; shared, not copied. \throws ParameterError if empty or a parameter is out of range
  Detector(std::vector<std::shared_ptr<const TrainedModel>> models, DetectorParameters parameters);

  struct Request
  {
    std::optional<Bin> bin;          ///< restricts the search; without it the whole cloud is searched
    std::vector<std::string> parts;  ///< names; empty: all
    double deadline = 0;             ///< seconds from the call; 0: parameters().deadline
    bool keep_segmentation = false;  ///< fill DetectionResult::segmentation
  };

  /// \throws CloudError if the cloud cannot be used, ParameterError for an unknown part name
  DetectionResult detect(const pcl::PointCloud<pcl::PointXYZ>& cloud, const Request& request) const;
  DetectionResult detect(const DepthGrid& grid, const Request& request) const;

  /// The (one) part in an unorganized oriented point set: no camera grid, no segmentation; voting, clustering, ICP
  /// (icp.method, without edges, since there is no grid) and matching rate only. Best first, each place once; of
  /// one matching rate, the one with smaller residuals. For whole scans and for the paper's public data sets.
  /// \param scene_is_part true: every scene point belongs to the part, so that all count in Equation 9; false: only
  ///   those inside the part's bounding box at the pose
  /// \throws ParameterError if the detector holds more than one model, a point has no normal or either is not finite;
  ///   CloudError Empty for no points
  DetectionResult match(const OrientedPoints& scene, bool scene_is_part) const;

  const std::vector<std::shared_ptr<const TrainedModel>>& models() const { return models_; }
  const DetectorParameters& parameters() const { return parameters_; }

private:
  DetectionResult detectIn(const PointView& points, const Request& request) const;
  std::vector<std::size_t> requestedModels(const Request& request) const;

  std::vector<std::shared_ptr<const TrainedModel>> models_;
  DetectorParameters parameters_;
  Executor executor_;
  std::vector<std::shared_ptr<const KdTree>> surfaces_;  ///< of the models, to find nearest neighbours
};
}  // namespace bin_picking
