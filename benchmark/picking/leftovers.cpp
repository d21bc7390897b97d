// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <set>

#include "bin_emptying.hpp"

namespace bin_picking::picking
{
namespace
{
constexpr double NEAR = 0.025;  // metres between the middles of a detection and the part that it stands for

/// Why none of these detections' grasps is made.
std::string causeFor(const GraspPlan& plan, const std::set<std::size_t>& detections)
{
  if (detections.empty())
    return "not_detected";
  if (std::any_of(plan.grasps.begin(), plan.grasps.end(),
                  [&](const PlannedGrasp& grasp) { return detections.count(grasp.detection) > 0; }))
    return "allowed";
  std::map<std::string, int> counts;
  for (const RejectedGrasp& grasp : plan.rejected)
    if (detections.count(grasp.detection))
      ++counts[grasp.cause];
  const auto most =
      std::max_element(counts.begin(), counts.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == counts.end() ? "no_grasps" : most->first;
}
}  // namespace

std::optional<std::size_t> trueInstance(const Detection& detection, const simulation::CellScan& scan,
                                        const simulation::VirtualCell& cell, const Detector& detector)
{
  const Eigen::Vector3d& center = detector.models()[detection.model_index]->center;
  std::optional<std::size_t> nearest;
  double distance = NEAR;
  for (std::size_t k = 0; k < scan.instances.size(); ++k)
  {
    const simulation::CellInstance& instance = scan.instances[k];
    if (cell.parts()[static_cast<std::size_t>(instance.part)].name != detection.part)
      continue;
    const double d = (instance.T_camera_object * center - detection.T_camera_object * center).norm();
    if (d < distance)
    {
      distance = d;
      nearest = k;
    }
  }
  return nearest;
}

std::map<std::string, int> leftovers(const simulation::CellScan& scan, const simulation::VirtualCell& cell,
                                     const Detector& detector, const DetectionResult& result, const GraspPlan& plan)
{
  std::vector<std::set<std::size_t>> detections(scan.instances.size());
  for (std::size_t d = 0; d < result.detections.size(); ++d)
    if (const auto instance = trueInstance(result.detections[d], scan, cell, detector))
      detections[*instance].insert(d);
  const std::vector<simulation::Body> bodies = cell.bodies();
  std::map<std::string, int> causes;
  for (std::size_t k = 0; k < detections.size(); ++k)
    if (std::any_of(bodies.begin(), bodies.end(),
                    [id = scan.instances[k].id](const simulation::Body& body) { return body.id == id; }))
      ++causes[causeFor(plan, detections[k])];
  return causes;
}
}  // namespace bin_picking::picking
