// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "virtual_cell.hpp"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "bin_mesh.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "random.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr double MAX_OVERLAP = 0.001;  // metres, between the surfaces of two parts at rest
constexpr int MAX_CORRECTIONS = 12;    // of one filling

std::vector<CellPart> checked(std::vector<CellPart> parts)
{
  if (parts.empty())
    throw ParameterError("a virtual cell needs at least one kind of part, but none was given");
  return parts;
}

CellParameters checked(const CellParameters& parameters)
{
  checkRanges(parameters);
  return parameters;
}

std::vector<std::shared_ptr<const RigidBodyShape>> rigidBodies(const std::vector<CellPart>& parts)
{
  std::vector<std::shared_ptr<const RigidBodyShape>> bodies;
  for (const CellPart& part : parts)
    try
    {
      auto body = std::make_shared<RigidBodyShape>(makeRigidBodyShape(*part.mesh));
      body->name = part.name;
      bodies.push_back(std::move(body));
    }
    catch (const ParameterError& error)
    {
      throw ParameterError("part '" + part.name + "': " + error.what());
    }
  return bodies;
}

Bin makeBin(const CellLayout& layout)
{
  Bin bin;
  bin.inner_size = {layout.bin_length, layout.bin_width, layout.bin_height};
  bin.wall_thickness = layout.wall_thickness;
  // Looking straight down x stays x, while y and z turn round; the tilt then leans the camera about its x axis.
  const Eigen::AngleAxisd down(M_PI, Eigen::Vector3d::UnitX());
  const Eigen::AngleAxisd lean(layout.camera_tilt, Eigen::Vector3d::UnitX());
  bin.T_camera_bin.linear() = (lean * down).toRotationMatrix();
  bin.T_camera_bin.translation() = Eigen::Vector3d(0, 0, layout.camera_distance);
  return bin;
}

/// Kinds in a random order: counts[k] times k.
std::vector<int> shuffled(const std::vector<int>& counts, std::uint32_t seed)
{
  std::vector<int> kinds;
  for (std::size_t k = 0; k < counts.size(); ++k)
    kinds.insert(kinds.end(), static_cast<std::size_t>(counts[k]), static_cast<int>(k));
  Random random(seed);
  for (int k = static_cast<int>(kinds.size()) - 1; k > 0; --k)
    std::swap(kinds[static_cast<std::size_t>(k)], kinds[static_cast<std::size_t>(random.below(k + 1))]);
  return kinds;
}
}  // namespace

VirtualCell::VirtualCell(std::vector<CellPart> parts, const CellParameters& parameters, int num_threads)
    : parts_(checked(std::move(parts))),
      parameters_(checked(parameters)),
      bin_(makeBin(parameters.layout)),
      bin_mesh_(std::make_shared<TriangleMesh>(meshOf(bin_, parameters.layout.table_size))),
      physics_(rigidBodies(parts_), bin_.inner_size, parameters.physics),
      sensor_(parameters.sensor, num_threads),
      executor_(num_threads)
{
  for (const CellPart& part : parts_)
    overlap_shapes_.push_back(std::make_unique<OverlapShape>(part.mesh));
}

void VirtualCell::fill(const std::vector<int>& counts, std::uint32_t seed, const BinPhysics::Progress& progress)
{
  const bool sensible = counts.size() == parts_.size() && *std::min_element(counts.begin(), counts.end()) >= 0;
  const auto total = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  if (!sensible || total == 0)
    throw ParameterError("a count for each of the " + std::to_string(parts_.size()) +
                         " kinds of parts is needed, 0 or more, and not all may be 0");
  const std::size_t already = physics_.bodies().size();
  if (already + total > MAX_CELL_PARTS)
    throw ParameterError("the bin would hold " + std::to_string(already + total) + " parts, but " +
                         std::to_string(MAX_CELL_PARTS) + " is the most");
  physics_.drop(shuffled(counts, seed), seed, progress);
  separate(seed);
}

bool VirtualCell::dropAgain(int id, std::uint32_t seed)
{
  if (!physics_.dropAgain(id, seed))
    return false;
  separate(seed);
  return true;
}

void VirtualCell::shake(std::uint32_t seed)
{
  std::vector<int> counts(parts_.size(), 0);
  for (const Body& body : bodies())
    ++counts[static_cast<std::size_t>(body.shape)];
  clear();
  fill(counts, seed);
}

/// The physics works with bodies a little simpler than the parts. Where that let two parts overlap, the upper one is
/// dropped again.
void VirtualCell::separate(std::uint32_t seed)
{
  Overlap overlap = deepestOverlap();
  for (std::uint32_t k = 1; k <= MAX_CORRECTIONS && overlap.depth > MAX_OVERLAP; ++k)
  {
    const std::vector<Body> all = bodies();
    const Body& first = all[overlap.first];
    const Body& second = all[overlap.second];
    const bool first_is_upper = first.T_bin_object.translation().z() > second.T_bin_object.translation().z();
    physics_.dropAgain(first_is_upper ? first.id : second.id, seed + k);
    overlap = deepestOverlap();
  }
  if (overlap.depth > MAX_OVERLAP)
    throw ParameterError("two parts still overlap by " + std::to_string(1000 * overlap.depth) + " mm after " +
                         std::to_string(MAX_CORRECTIONS) +
                         " corrections, but 1 mm is the most; take a shorter physics/time_step, fewer parts or a "
                         "larger bin");
}

Overlap VirtualCell::deepestOverlap() const
{
  std::vector<PlacedShape> placed;
  for (const Body& body : bodies())
    placed.push_back({overlap_shapes_[static_cast<std::size_t>(body.shape)].get(), body.T_bin_object});
  return simulation::deepestOverlap(placed, executor_);
}

CellScan VirtualCell::scan(std::uint32_t seed)
{
  CellScan result;
  std::vector<SceneObject> objects;
  for (const Body& body : bodies())
  {
    result.instances.push_back({body.id, body.shape, bin_.T_camera_bin * body.T_bin_object, {}});
    objects.push_back({parts_[static_cast<std::size_t>(body.shape)].mesh, result.instances.back().T_camera_object});
  }
  const auto bin_label = static_cast<std::int32_t>(objects.size());
  objects.push_back({bin_mesh_, bin_.T_camera_bin});
  result.scan = sensor_.scan(objects, seed);
  for (std::size_t k = 0; k < result.instances.size(); ++k)
    result.instances[k].view = result.scan.views[k];
  result.scan.views.pop_back();
  std::replace(result.scan.labels.begin(), result.scan.labels.end(), bin_label, std::int32_t{-1});
  return result;
}

void CellLayout::visit(ParameterVisitor& v)
{
  v.field({"bin_length", "m", "inner length of the bin", 0.05, 2}, bin_length);
  v.field({"bin_width", "m", "inner width of the bin", 0.05, 2}, bin_width);
  v.field({"bin_height", "m", "inner height of the bin", 0.01, 1}, bin_height);
  v.field({"wall_thickness", "m", "of walls and floor", 0.0005, 0.05}, wall_thickness);
  v.field({"table_size", "m", "edge of the square table on which the bin stands; 0: nothing around the bin", 0, 5},
          table_size);
  v.field({"camera_distance", "m", "from the camera to the middle of the bin's floor", 0.2, 5}, camera_distance);
  v.field({"camera_tilt", "rad", "of the optical axis against the vertical", 0, 0.8}, camera_tilt);
}

void CellParameters::visit(ParameterVisitor& v)
{
  v.group("layout", layout);
  v.group("physics", physics);
  v.group("sensor", sensor);
}
}  // namespace bin_picking::simulation
