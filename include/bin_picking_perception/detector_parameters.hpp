// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/matching/clustering.hpp"
#include "bin_picking_perception/matching/voting.hpp"
#include "bin_picking_perception/refinement/icp.hpp"
#include "bin_picking_perception/refinement/verification.hpp"
#include "bin_picking_perception/scene/cloud_input.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "bin_picking_perception/segmentation/segmentation.hpp"

namespace bin_picking
{
/// Parameters of the online phase, one struct per stage.
struct DetectorParameters
{
  InputParameters input;
  PreprocessingParameters preprocessing;
  SegmentationParameters segmentation;
  VotingParameters voting;
  ClusteringParameters clustering;
  IcpParameters icp;
  VerificationParameters verification;
  int num_threads = 0;  // 0: all processors
  double deadline = 0;  // seconds; 0: none
  int max_detections = 50;
  int max_rejected = 20;

  void visit(ParameterVisitor& v);

  /// "paper": every choice as in the text; "fast"; "accurate". \throws ParameterError otherwise, listing them
  static DetectorParameters preset(const std::string& name);
};
}  // namespace bin_picking
