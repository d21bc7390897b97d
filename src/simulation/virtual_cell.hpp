// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bin_physics.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "bin_picking_perception/scene/bin.hpp"
#include "overlap.hpp"
#include "sensor.hpp"

namespace bin_picking::simulation
{
constexpr std::size_t MAX_CELL_PARTS = 60;

/// Inner measures of the bin, and how the camera hangs over it.
struct CellLayout
{
  double bin_length = 0.4;
  double bin_width = 0.3;
  double bin_height = 0.15;
  double wall_thickness = 0.005;
  double table_size = 1.2;
  double camera_distance = 0.8;
  double camera_tilt = 0.14;

  void visit(ParameterVisitor& v);
};

struct CellParameters
{
  CellLayout layout;
  PhysicsParameters physics;
  SensorParameters sensor;

  void visit(ParameterVisitor& v);
};

/// A kind of part that lies in the bin.
struct CellPart
{
  std::string name;
  std::shared_ptr<const TriangleMesh> mesh;
};

/// A part in the bin, and how much the last scan could see of it.
struct CellInstance
{
  int id = 0;
  int part = 0;  ///< index into the cell's parts
  Pose T_camera_object = Pose::Identity();
  ObjectView view;
};

struct CellScan
{
  Scan scan;  ///< labels: index into instances; -1: bin or nothing
  std::vector<CellInstance> instances;
};

/// A bin under a 3D sensor, with parts that obey physics: what a real cell is to the perception, without the cell.
/// Not thread-safe.
class VirtualCell
{
public:
  /// \throws ParameterError no parts, a parameter out of its range, a mesh that is not closed, a part larger than the
  ///   bin
  VirtualCell(std::vector<CellPart> parts, const CellParameters& parameters, int num_threads = 0);

  /// Drops counts[k] parts of kind k, mixed at random, on top of what is there; returns when all rest.
  /// \throws ParameterError counts that do not fit the parts, none or more than MAX_CELL_PARTS parts in all, a bin too
  /// full; in the
  ///   last case what was dropped stays in the bin
  void fill(const std::vector<int>& counts, std::uint32_t seed, const BinPhysics::Progress& progress = {});

  /// The two parts that reach deepest into each other, by their true meshes: indices into bodies(). Never more than
  /// 1 mm after fill() and dropAgain().
  Overlap deepestOverlap() const;

  /// One exposure. The seed is that of the noise.
  CellScan scan(std::uint32_t seed);

  /// See BinPhysics.
  bool remove(int id) { return physics_.remove(id); }
  bool dropAgain(int id, std::uint32_t seed);
  /// Shakes the bin up: all that lies in it falls anew, under new ids. \throws as fill()
  void shake(std::uint32_t seed);
  void clear() { physics_.clear(); }

  /// Ids, kinds and poses T_bin_object of what lies in the bin.
  std::vector<Body> bodies() const { return physics_.bodies(); }
  const Bin& bin() const { return bin_; }
  const std::vector<CellPart>& parts() const { return parts_; }
  const CellParameters& parameters() const { return parameters_; }
  PinholeCamera camera() const { return sensor_.camera(); }

private:
  void separate(std::uint32_t seed);

  std::vector<CellPart> parts_;
  CellParameters parameters_;
  Bin bin_;
  std::shared_ptr<const TriangleMesh> bin_mesh_;
  BinPhysics physics_;
  VirtualSensor sensor_;
  Executor executor_;
  std::vector<std::unique_ptr<OverlapShape>> overlap_shapes_;  ///< per kind of part
};
}  // namespace bin_picking::simulation
