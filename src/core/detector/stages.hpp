// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bin_picking_perception/common/deadline.hpp"
#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/matching/clustering.hpp"
#include "bin_picking_perception/refinement/verification.hpp"
#include "bin_picking_perception/scene/depth_edges.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "stage_clock.hpp"

namespace bin_picking
{
/// The scene as one model sees it: at its leaf, with its radii.
struct PreparedScene
{
  DepthGrid surroundings;                ///< working grid with what lies outside of the region: bin, floor, table
  DepthGrid grid;                        ///< working grid, only the region where parts are searched
  int reduction = 1;                     ///< raw pixels per pixel of the working grid
  ConnectedRuns runs;                    ///< of the working grid
  DepthEdges edges;                      ///< of the working grid
  std::vector<Eigen::Vector3f> normals;  ///< per pixel of the working grid
  double noise = 0;                      ///< of the depth, metres
  SceneSamples samples;
  OrientedPoints edge_points;             ///< thinned as the samples are
  std::optional<Bin> bin;                 ///< as given with the request
  const KdTree* model_surface = nullptr;  ///< of the model, to find nearest neighbours
};

/// Where poses are searched: samples that take part, and those of them that vote. One per candidate target in the
/// `paper` preset; one for everything where segments are only a hint.
struct SearchRegion
{
  SceneSamples samples;
  std::vector<int> references;  ///< into samples
  int keep_clusters = 0;
  bool is_candidate = false;  ///< the samples are one candidate target: the "object points" of Equation 9
};

/// A cluster on its way to a detection.
struct Hypothetical
{
  Pose T_camera_object = Pose::Identity();
  double votes = 0;
  const SearchRegion* region = nullptr;
};

/// Reduction, limits and outliers; the rest follows only if there is anything.
PreparedScene reduceScene(const PointView& raw, const Bin* bin, const TrainedModel& model,
                          const DetectorParameters& parameters, const Executor& executor, StageClock& clock);

/// Measured raw pixels inside the region, estimated from the working grid: what there is to search.
double measuredPoints(const PreparedScene& scene);

/// What tells an empty bin from one that was not seen. Parts see the scene at their own leaf: the most of all counts.
struct BinContent
{
  bool has_bin = false;
  double points = 0;        ///< measured raw pixels inside the region that are not beside a wall of the bin
  double beside_walls = 0;  ///< the others: walls, or parts that lean on them
  double floor_share =
      0;  ///< of the bin's floor that is measured, of the picture without a bin; only where points are few

  void look(const PreparedScene& scene, const InputParameters& parameters);
  bool isLittle(const InputParameters& parameters) const { return points < parameters.empty_bin_points; }
  /// Sets code and message. \pre little, and nothing was found
  void describe(const InputParameters& parameters, DetectionResult& result) const;
};

/// Normals, samples and curvature.
void describeScene(PreparedScene& scene, const TrainedModel& model, const DetectorParameters& parameters,
                   const Executor& executor, StageClock& clock);

std::vector<SearchRegion> planSearch(const PreparedScene& scene, const Segmentation& segmentation,
                                     const std::vector<CandidateTarget>& candidates, const TrainedModel& model,
                                     const DetectorParameters& parameters);

/// What a few points of a pose from votes say about it. Scene, model and parameters must outlive it.
class Glance
{
public:
  Glance(const PreparedScene& scene, const TrainedModel& model, const VerificationParameters& parameters);

  /// promise() of the pose.
  double at(const Pose& T_camera_object) const;

private:
  const PreparedScene& scene_;
  const TrainedModel& model_;
  const VerificationParameters& parameters_;
  FacingPoints facing_;
};

/// Of each reference point the hypotheses that a glance contradicts least. \param hypotheses ordered by reference
std::vector<Hypothesis> keepPromising(const std::vector<Hypothesis>& hypotheses, std::size_t per_reference,
                                      const Glance& glance, const Executor& executor);

/// Those that a glance contradicts least, in their order. \param share of the poses
std::vector<Hypothetical> keepPromising(const std::vector<Hypothetical>& poses, double share, const Glance& glance,
                                        const Executor& executor);

/// Voting and clustering in every region. \param scene nullptr: there is no grid to hold hypotheses against
/// \param partial set if the deadline passed
std::vector<Hypothetical> searchPoses(const std::vector<SearchRegion>& regions, const PreparedScene* scene,
                                      const TrainedModel& model, const DetectorParameters& parameters,
                                      const Deadline& deadline, const Executor& executor, StageClock& clock,
                                      bool& partial);

/// A refined pose with the image cells that it explains.
struct Assessed
{
  Detection detection;
  std::vector<int> cells;
};

/// What ranks poses before they are refined, [0, 1].
double promise(const PoseEvidence& evidence, const VerificationParameters& parameters);

/// Distance to the part's surface that still explains a measured point, metres.
double depthTolerance(const PreparedScene& scene, const TrainedModel& model, const VerificationParameters& parameters);

/// One pose refined, settled among its rivals, and tested; once more from there if it fails by little.
Assessed assess(const Hypothetical& pose, const PreparedScene& scene, const TrainedModel& model,
                const DetectorParameters& parameters, int comparison_cell);

/// Edge of the image cells by which poses are compared: about a leaf of the coarsest model, in raw pixels.
int comparisonCell(const PointView& raw, const std::vector<std::shared_ptr<const TrainedModel>>& models);

/// The most promising poses, refined by ICP and tested, without those that lie where better ones were accepted.
std::vector<Assessed> refineAndVerify(const std::vector<Hypothetical>& poses, const PreparedScene& scene,
                                      const TrainedModel& model, const DetectorParameters& parameters,
                                      int comparison_cell, const Deadline& deadline, const Executor& executor,
                                      StageClock& clock, bool& partial);

/// Share of a pose's cells that others explain. \param cells, explained ascending
double sharedPart(const std::vector<int>& cells, const std::vector<int>& explained);

/// "score is 0.41, but must be at least 0.42".
std::string failureText(const Criterion& criterion);

/// Sets the code and the message from what was found, rejected and left undone.
void summarize(DetectionResult& result);

/// Sorts by score; rejects what failed a criterion, and what explains the same cells as poses that explain more.
void selectDetections(std::vector<Assessed> assessed, const DetectorParameters& parameters, DetectionResult& result);
}  // namespace bin_picking
