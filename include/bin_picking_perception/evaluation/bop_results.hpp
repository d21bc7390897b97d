// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>
#include <vector>

#include "bin_picking_perception/evaluation/scene_judgement.hpp"

namespace bin_picking
{
/// A line of a results file of the BOP benchmark.
struct BopResult
{
  int scene_id = 0;
  int image_id = 0;
  int object_id = 0;
  double score = 0;
  Pose T_camera_object = Pose::Identity();  ///< metres (millimetres in the file)
  double seconds = -1;                      ///< for the whole image; -1: not measured
};

/// Reads `scene_id,im_id,obj_id,score,R,t,time`: R nine numbers row by row, t three, millimetres.
/// \throws FileError missing; another header; a line that is not of that form, with its number; R no rotation
std::vector<BopResult> loadBopResults(const std::string& path);

/// The text of such a file, with every digit that the numbers have.
std::string bopResultsCsv(const std::vector<BopResult>& results);

/// Estimates per scene of the data set, and the times that the file states.
struct ResultsOfScenes
{
  std::vector<std::vector<PoseEstimate>> estimates;
  std::vector<double> seconds;  ///< -1: not stated
  std::size_t left_out = 0;     ///< lines about scenes or parts that are not searched for
};

/// \throws FileError not one line belongs to the data set (it names some ids of either side)
ResultsOfScenes assignToScenes(const std::vector<BopResult>& results, const EvaluationDataset& dataset,
                               const std::string& origin);
}  // namespace bin_picking
