// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "bin_picking_perception/model/part.hpp"
#include "bin_picking_perception/scene/bin.hpp"
#include "bin_picking_perception/scene/cloud_input.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking
{
/// A part that lies in a scene.
struct TrueInstance
{
  std::string part;
  Pose T_camera_object = Pose::Identity();
  /// Share of the part's silhouette that nothing hides, [0, 1]; NaN: the data set does not say (estimateVisibility
  /// does).
  double visible_fraction = std::numeric_limits<double>::quiet_NaN();
  int visible_pixels = 0;  ///< that nothing hides; 0: not said
  int valid_pixels = 0;    ///< of them measured by the sensor; 0: not said
};

/// How a 16-bit depth picture is read.
struct DepthImageFormat
{
  PinholeCamera camera;
  double step = 0.001;      ///< metres per unit of the picture
  std::string color_image;  ///< picture of the same pixels; empty: none
};

/// One scan with its truth. The scan itself stays in its file until it is loaded.
struct EvaluationScene
{
  std::string name;  ///< of its folder, or scene/image
  int scene_id = 0;  ///< as in a results file
  int image_id = 0;
  std::string file;                             ///< organized cloud, or depth picture
  std::optional<DepthImageFormat> depth_image;  ///< absent: the file is a PCD
  int width = 0;                                ///< pixels that the data set announces; 0: none announced
  int height = 0;
  std::optional<Bin> bin;
  std::vector<std::string> parts;       ///< that are searched for here, also when none is there
  std::vector<TrueInstance> instances;  ///< of those parts
};

struct EvaluationPart
{
  PartDefinition definition;
  int object_id = 0;    ///< as in a results file
  double diameter = 0;  ///< metres, as the data set states it; 0: to be measured on the mesh
};

struct EvaluationDataset
{
  std::string path;
  std::vector<EvaluationPart> parts;    ///< those that some scene searches for
  std::vector<EvaluationScene> scenes;  ///< at least one
};

/// What of a data set is used.
struct DatasetSelection
{
  std::string split;               ///< of the BOP format; empty: the only one
  std::vector<std::string> parts;  ///< names, or folders with a part.yaml that replaces the data set's; empty: all
  int max_scenes = 0;              ///< the first so many; 0: all
};

/// Reads which scenes and parts there are and all true poses, in the own format (scene folders with scene.pcd and
/// truth.json) or that of the BOP benchmark; docs/evaluation.md describes both.
/// \throws FileError neither format; a missing or broken file; a pose that is no rigid motion; an unknown part
/// \throws ParameterError the selection names a split or part that is not there
EvaluationDataset openDataset(const std::string& path, const DatasetSelection& selection);

/// The scan of a scene that is no depth picture, as a driver hands it over.
/// \throws FileError as loadSceneGrid
pcl::PointCloud<pcl::PointXYZ> loadSceneCloud(const EvaluationScene& scene);

/// The scan. In depth pictures 0 is "not measured".
/// \throws FileError missing, not readable, of another size than announced; CloudError as makeGrid
DepthGrid loadSceneGrid(const EvaluationScene& scene, const InputParameters& parameters);
}  // namespace bin_picking
