// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "depth_check.hpp"

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/scene/cloud_input.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"

namespace bin_picking::peers
{
namespace
{
constexpr int REDUCTION = 4;              // pixels of the scan per pixel that is compared, each way
constexpr double TOLERANCE = 0.002;       // metres
constexpr double MIN_SUPPORT = 0.6;       // explained among explained and contradicted
constexpr double MIN_VISIBLE = 0.3;       // explained among all that the camera would see
constexpr double MAX_CONTRADICTED = 0.2;  // free space among all
constexpr double MAX_SHARED = 0.35;       // explained pixels that a better pose has explained already

struct Evidence
{
  PeerPose pose;
  std::vector<int> explained;  ///< pixels
};

Evidence gather(const PeerPose& pose, const PeerModel& model, const DepthGrid& searched, const DepthGrid& measured)
{
  DepthRenderer renderer(measured.width, measured.height, measured.camera);
  renderer.draw(model.mesh, pose.T_camera_object, 0);
  Evidence evidence;
  int visible = 0;
  int off = 0;
  int free = 0;
  for (int i = 0; i < static_cast<int>(measured.size()); ++i)
  {
    const double expected = static_cast<double>(renderer.depth()[static_cast<std::size_t>(i)]);
    if (!std::isfinite(expected))
      continue;
    ++visible;
    if (!measured.valid(i))
      continue;
    const double behind = static_cast<double>(measured.z[static_cast<std::size_t>(i)]) - expected;
    if (std::abs(behind) <= TOLERANCE && searched.valid(i))
      evidence.explained.push_back(i);
    else if (behind > TOLERANCE)
      ++free;
    else if (behind > -3 * TOLERANCE)
      ++off;
  }
  const double explained = static_cast<double>(evidence.explained.size());
  const double support = explained / std::max(1.0, explained + off + free);
  const double seen = explained / std::max(1, visible);
  const bool accepted =
      support >= MIN_SUPPORT && seen >= MIN_VISIBLE && free <= MAX_CONTRADICTED * static_cast<double>(visible);
  evidence.pose = {pose.T_camera_object, accepted ? support * std::sqrt(seen) : 0};
  return evidence;
}
}  // namespace

std::vector<PeerPose> checkedByDepth(const std::vector<PeerPose>& poses, const PeerModel& model, const PeerScene& scene)
{
  const DepthGrid measured = reduceGrid(scene.grid, REDUCTION, Executor(1));
  DepthGrid searched = measured;
  cropToRegion(searched, {}, scene.bin ? &*scene.bin : nullptr, Executor(1));
  std::vector<Evidence> all;
  for (const PeerPose& pose : poses)
    all.push_back(gather(pose, model, searched, measured));
  std::stable_sort(all.begin(), all.end(),
                   [](const Evidence& a, const Evidence& b) { return a.pose.score > b.pose.score; });
  std::vector<bool> taken(measured.size(), false);
  std::vector<PeerPose> accepted;
  for (const Evidence& evidence : all)
  {
    const auto shared = std::count_if(evidence.explained.begin(), evidence.explained.end(),
                                      [&](int i) { return taken[static_cast<std::size_t>(i)]; });
    if (evidence.pose.score <= 0 ||
        static_cast<double>(shared) > MAX_SHARED * static_cast<double>(evidence.explained.size()))
      continue;
    for (const int i : evidence.explained)
      taken[static_cast<std::size_t>(i)] = true;
    accepted.push_back(evidence.pose);
  }
  return accepted;
}
}  // namespace bin_picking::peers
