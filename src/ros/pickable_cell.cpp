// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "pickable_cell.hpp"

#include <algorithm>
#include <memory>

#include "bin_picking_perception/common/error.hpp"
#include "part_loading.hpp"
#include "resource_path.hpp"

namespace bin_picking_ros
{
namespace
{
using bin_picking::Pose;
using bin_picking::TriangleMesh;
using bin_picking::simulation::Body;
using bin_picking::simulation::CellPart;

constexpr std::uint32_t LUCK_STREAM = 0x9e3779b9;  // keeps the seeds of the two streams of random numbers apart

std::vector<CellPart> loadCellParts(const std::vector<std::string>& directories)
{
  std::vector<CellPart> parts;
  for (const bin_picking::PartDefinition& definition : loadParts(directories))
  {
    auto mesh = std::make_shared<const TriangleMesh>(bin_picking::loadMesh(definition.mesh_file, definition.mesh_unit));
    bin_picking::checkExpectedSize(definition, bin_picking::inspectMesh(*mesh).size);
    parts.push_back({definition.name, std::move(mesh)});
  }
  return parts;
}

/// The errors of the simulation are those of its parameters: here, at work, nobody has given any.
template <typename Work>
void simulate(const Work& work)
{
  try
  {
    work();
  }
  catch (const bin_picking::Error& error)
  {
    throw PhysicsFailure(std::string("The simulation of the bin failed; call ~refill: ") + error.what());
  }
}

Eigen::Vector3d surfaceCenter(const TriangleMesh& mesh)
{
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double area = 0;
  for (const auto& triangle : mesh.triangles)
  {
    const Eigen::Vector3d a = mesh.vertices[triangle[0]].cast<double>();
    const Eigen::Vector3d b = mesh.vertices[triangle[1]].cast<double>();
    const Eigen::Vector3d c = mesh.vertices[triangle[2]].cast<double>();
    const double weight = (b - a).cross(c - a).norm();
    sum += weight / 3 * (a + b + c);
    area += weight;
  }
  return sum / area;
}
}  // namespace

PickableCell::PickableCell(const VirtualCellParameters& parameters)
    : parameters_(parameters),
      parts_(loadCellParts(parameters.parts)),
      next_seed_(static_cast<std::uint32_t>(parameters.seed)),
      exposure_seeds_(next_seed_),
      luck_(next_seed_ ^ LUCK_STREAM)
{
  for (const CellPart& part : parts_)
    centers_.push_back(surfaceCenter(*part.mesh));
  if (!parameters.gripper.empty())
    gripper_ = bin_picking::loadGripper(resolveResource(parameters.gripper));
}

void PickableCell::refill(const Progress& progress)
{
  cell_.reset();
  cell_.emplace(parts_, parameters_.cell, parameters_.num_threads);
  if (!judge_)
    judge_.emplace(*cell_);
  cell_->fill(parameters_.counts, next_seed_++, progress);
}

void PickableCell::shake()
{
  const auto seed = static_cast<std::uint32_t>(luck_.below(1 << 30));
  simulate([&] { cell_->shake(seed); });
}

bin_picking::simulation::CellScan PickableCell::expose()
{
  return cell_->scan(static_cast<std::uint32_t>(exposure_seeds_()));
}

PickOutcome PickableCell::take(int id)
{
  const std::vector<Body> bodies = cell_->bodies();
  const auto body = std::find_if(bodies.begin(), bodies.end(), [id](const Body& b) { return b.id == id; });
  PickOutcome outcome;
  outcome.num_left = bodies.size();
  if (body == bodies.end())
    return outcome;
  outcome.id = id;
  outcome.part = parts_.at(static_cast<std::size_t>(body->shape)).name;
  outcome.kind = takeGripped(id);
  outcome.num_left = numLeft();
  return outcome;
}

PickOutcome::Kind PickableCell::takeGripped(int id)
{
  if (luck_.uniform(0, 1) < parameters_.failure_probability)
    return PickOutcome::Kind::Missed;
  if (luck_.uniform(0, 1) < parameters_.drop_probability)
  {
    const auto seed = static_cast<std::uint32_t>(luck_.below(1 << 30));
    simulate([&] { cell_->dropAgain(id, seed); });
    return PickOutcome::Kind::DroppedBack;
  }
  simulate([&] { cell_->remove(id); });
  return PickOutcome::Kind::Taken;
}

GripOutcome PickableCell::grip(const bin_picking::simulation::GripPath& path)
{
  if (!gripper_)
    throw bin_picking::ParameterError("no gripper is mounted; name its file in the parameter gripper");
  GripOutcome outcome;
  const std::vector<Body> bodies = cell_->bodies();
  outcome.verdict = judge_->tryGrip(bodies, *gripper_, path, -1, parameters_.grip);
  for (const Body& body : bodies)
    if (body.id == outcome.verdict.id)
      outcome.part = parts_.at(static_cast<std::size_t>(body.shape)).name;
  if (outcome.verdict.outcome == bin_picking::simulation::GripVerdict::Outcome::Taken)
    outcome.kind = takeGripped(outcome.verdict.id);
  outcome.num_left = numLeft();
  return outcome;
}

std::optional<int> PickableCell::partAt(const Pose& T_camera_object, const std::string& part, double tolerance) const
{
  std::optional<int> nearest;
  for (const Body& body : cell_->bodies())
  {
    const auto kind = static_cast<std::size_t>(body.shape);
    if (!part.empty() && parts_[kind].name != part)
      continue;
    const Eigen::Vector3d truth_camera = cell_->bin().T_camera_bin * body.T_bin_object * centers_[kind];
    const double distance = (T_camera_object * centers_[kind] - truth_camera).norm();
    if (distance < tolerance)  // of equal ones the first that was dropped
    {
      tolerance = distance;
      nearest = body.id;
    }
  }
  return nearest;
}

bool PickableCell::hasPart(const std::string& name) const
{
  return std::any_of(parts_.begin(), parts_.end(), [&name](const CellPart& part) { return part.name == name; });
}
}  // namespace bin_picking_ros
