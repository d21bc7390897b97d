// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/detector_parameters.hpp"

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
void DetectorParameters::visit(ParameterVisitor& v)
{
  v.field(
      {"num_threads", "", "threads of a detection; 0 = all processors. The result is the same for any number", 0, 256},
      num_threads);
  v.field({"deadline", "s", "when it passes, what is ready is returned and marked partial; 0 = none", 0, 600},
          deadline);
  v.field({"max_detections", "", "best detections that are returned", 1, 1000}, max_detections);
  v.field({"max_rejected", "", "rejected poses that are returned with their reasons", 0, 1000}, max_rejected);
  v.group("input", input);
  v.group("preprocessing", preprocessing);
  v.group("segmentation", segmentation);
  v.group("voting", voting);
  v.group("clustering", clustering);
  v.group("icp", icp);
  v.group("verification", verification);
}

namespace
{
/// Every choice as in the text of Cui et al. 2022; the constants of its parts are in config/paper.
DetectorParameters paperPreset()
{
  DetectorParameters p;
  p.segmentation.method = SegmentationMethod::Watershed;
  p.segmentation.veto = true;
  p.segmentation.step = 1;
  p.voting.reference_share = 0.2;
  p.voting.min_references = 1;
  p.voting.max_pair_distance = 1;
  p.voting.weight = 3;
  p.voting.edge_weight = 0;
  p.voting.curvature_spread = 0;
  p.voting.curvature_wildcard = false;
  p.voting.max_bucket = 0;
  p.voting.max_votes = 0;
  p.voting.skip_repeated = false;
  p.voting.peaks_per_reference = 1;
  p.voting.sum_adjacent_angles = false;
  p.clustering.max_clusters = 1000;
  p.clustering.promising_share = 1;
  p.icp.method = IcpMethod::PointToPoint;
  p.icp.max_iterations = 50;
  p.icp.max_distance = 3;
  p.verification.enabled = false;
  p.verification.fruitless_rounds = 4;
  return p;
}

DetectorParameters accuratePreset()
{
  DetectorParameters p;
  p.segmentation.step = 1;
  p.voting.reference_share = 0.1;
  p.voting.min_references = 40;
  p.voting.max_pair_distance = 1;
  p.voting.max_votes = 60000;
  p.voting.peaks_per_reference = 20;
  p.voting.min_peak_share = 0.3;
  p.clustering.poses_per_reference = 4;
  p.clustering.max_clusters = 1000;
  p.clustering.promising_share = 1;
  p.verification.max_refined = 120;
  p.icp.max_iterations = 16;
  p.verification.fruitless_rounds = 8;
  return p;
}
}  // namespace

DetectorParameters DetectorParameters::preset(const std::string& name)
{
  if (name == "fast")
    return {};
  if (name == "paper")
    return paperPreset();
  if (name == "accurate")
    return accuratePreset();
  const std::string guess = didYouMean(name, {"paper", "fast", "accurate"});
  throw ParameterError("unknown preset '" + name + "'; there are paper, fast and accurate" +
                       (guess.empty() ? "" : " (did you mean '" + guess + "'?)"));
}
}  // namespace bin_picking
