// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/curvature_classes.hpp"
#include "bin_picking_perception/model/distance_field.hpp"
#include "bin_picking_perception/model/feature_table.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "bin_picking_perception/model/near_symmetry.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "bin_picking_perception/model/training_parameters.hpp"

namespace bin_picking
{
/// What a camera far away sees of the part from one direction.
struct ViewTemplate
{
  Eigen::Vector3f direction = Eigen::Vector3f::UnitZ();  ///< from the part towards the camera, part frame, unit
  float area = 0;                                        ///< of the silhouette, square metres
  float contour = 0;                                     ///< length of the silhouette's contours (holes too), metres
  std::vector<std::uint32_t> visible;                    ///< indices into TrainedModel::surface
};

/// Everything that the online phase needs to know about a part. Immutable; share it between threads.
struct TrainedModel
{
  std::string name;
  std::uint64_t mesh_hash = 0;
  std::uint64_t parameter_hash = 0;
  TrainingParameters parameters;  ///< effective ones: no "automatic" value is left
  Symmetry symmetry;
  TriangleMesh mesh;                                 ///< empty for point models
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    ///< bounding box, metres
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< its middle, part frame
  double diameter = 0;                               ///< largest distance of two surface points, metres
  OrientedPoints points;                             ///< at the leaf, with curvature: the rows of the accumulator
  OrientedPoints surface;                            ///< finer, outer surface only: for verification and refinement
  std::vector<ViewTemplate> views;
  CurvatureClasses classes;
  FeatureTable table;
  OrientedPoints edges;     ///< of its faces, each with the direction in which the face ends (edgePoints); may be none
  FeatureTable edge_table;  ///< pairs of `points` with `edges`; its references are those of `table`
  std::vector<std::string> remarks;  ///< what training found out about the part, sentences for people
  DistanceField field;               ///< of the mesh, or of the surface points of a part without one
  std::vector<NearSymmetry> near_symmetries;
  std::vector<std::uint8_t> near_crease;  ///< per surface point: within normal_radius the surface bends sharply
};

/// The offline phase for a mesh file or a point model. `definition.mesh_file` and `mesh_unit` are read; symmetry and
/// the training overrides are taken from the definition. \param progress called with a stage name now and then; may be
/// empty
std::shared_ptr<const TrainedModel> trainPart(const PartDefinition& definition, const TrainingParameters& parameters,
                                              const Executor& executor,
                                              const std::function<void(const std::string&)>& progress = {});

/// The symmetry that training gives the part: the stated one, otherwise what its surface shows at the automatic leaf or
/// that of the definition. Takes some tenths of a second where it has to look. \throws FileError a mesh that cannot be
/// used \throws ParameterError as trainPart does: the size is not the expected one, or the leaf does not fit it
Symmetry symmetryOf(const PartDefinition& definition, const Executor& executor);

/// Hash of what a model is asked to be: name, unit, symmetry and every parameter, with the part's own `training:`
/// values. \throws ParameterError the part's training values are not valid
std::uint64_t requestHash(const PartDefinition& definition, const TrainingParameters& parameters);

/// Version of the model file's layout and of what training puts there; other versions are not read.
constexpr std::uint32_t MODEL_FILE_VERSION = 7;

/// Binary file: magic, version, hashes, payload, checksum. Written to a temporary name first, then renamed.
/// \throws FileError cannot be written
void saveModel(const TrainedModel& model, const std::string& path);

/// \throws ModelFileError missing, not a model file, other version, truncated, checksum wrong
std::shared_ptr<const TrainedModel> loadModel(const std::string& path);

/// The model in `path` if it was made from this part and these parameters; trains and saves otherwise.
/// \param note receives one sentence about why it was trained again (and another if the file could not be written: the
///   model itself is good), empty if it was not
std::shared_ptr<const TrainedModel> loadOrTrain(const PartDefinition& definition, const TrainingParameters& parameters,
                                                const std::string& path, const Executor& executor, std::string& note);
}  // namespace bin_picking
