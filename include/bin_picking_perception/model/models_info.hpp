// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>

#include "bin_picking_perception/model/mesh.hpp"
#include "bin_picking_perception/model/part.hpp"

namespace bin_picking
{
/// What models_info.json says of one model: the file beside the meshes of a data set of the BOP benchmark
/// (https://bop.felk.cvut.cz, https://github.com/thodan/bop_toolkit). Metres here, millimetres in the file.
struct ModelInfo
{
  double diameter = 0;                                   ///< largest distance of two vertices
  Eigen::Vector3d min_corner = Eigen::Vector3d::Zero();  ///< of the bounding box, model frame
  Eigen::Vector3d size = Eigen::Vector3d::Zero();        ///< of the bounding box
  Symmetry symmetry;
};

/// Reads a models_info.json: the models by their ids. Keys beyond the convention's are ignored.
///
/// `symmetries_discrete` (4x4 matrices, row by row) may lack the identity and products of its elements; they are added.
/// Data sets also list motions that were fitted to scans and hardly compose to a group: products within 1.5 degrees and
/// 1 % of the diameter of another element are that element. `symmetries_continuous` has at most one axis here.
/// \throws FileError missing, not JSON, no models, a missing or absurd diameter or box, a matrix that is no rigid
/// motion, an
///   axis that is not of unit length, symmetries that contradict each other; the text names the model and the entry
std::map<int, ModelInfo> loadModelsInfo(const std::string& path);

/// Writes a models_info.json that loadModelsInfo, and the tools of the benchmark, read. The identity is not listed.
/// \throws ParameterError a negative id, or a diameter or box that loadModelsInfo would refuse
/// \throws FileError the file cannot be written; an older one is then as it was
void saveModelsInfo(const std::map<int, ModelInfo>& models, const std::string& path);

/// \throws ParameterError the mesh has no triangles
ModelInfo describeModel(const TriangleMesh& mesh, const Symmetry& symmetry);
}  // namespace bin_picking
