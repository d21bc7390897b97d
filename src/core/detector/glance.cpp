// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>

#include "bin_picking_perception/common/parallel.hpp"
#include "stages.hpp"

namespace bin_picking
{
std::vector<Hypothesis> keepPromising(const std::vector<Hypothesis>& hypotheses, std::size_t per_reference,
                                      const PreparedScene& scene, const TrainedModel& model,
                                      const VerificationParameters& parameters, const Executor& executor)
{
  constexpr std::size_t GLANCE_POINTS = 20;
  constexpr std::size_t BLOCK = 64;
  // The pose of one reference point is off by about the distance of the points that voted.
  const double tolerance = model.parameters.matching_leaf;
  const FacingPoints facing(model, GLANCE_POINTS);
  std::vector<std::pair<double, std::size_t>> ranked(hypotheses.size());
  executor.forEach((hypotheses.size() + BLOCK - 1) / BLOCK, [&](std::size_t block) {
    for (std::size_t i = block * BLOCK; i < std::min(hypotheses.size(), (block + 1) * BLOCK); ++i)
    {
      const Pose& T = hypotheses[i].T_camera_object;
      const PoseEvidence evidence =
          gatherEvidence(facing.at(T), T, scene.grid, scene.surroundings, scene.normals, tolerance, parameters);
      ranked[i] = {-promise(evidence, parameters), i};
    }
  });
  // A reference point lies on one part: few of its poses are worth more, however good those of others look.
  std::vector<Hypothesis> kept;
  for (std::size_t begin = 0, end = 0; begin < ranked.size(); begin = end)
  {
    while (end < ranked.size() && hypotheses[end].reference == hypotheses[begin].reference)
      ++end;
    const auto first = ranked.begin() + static_cast<std::ptrdiff_t>(begin);
    std::sort(first, ranked.begin() + static_cast<std::ptrdiff_t>(end));
    for (std::size_t k = begin; k < std::min(end, begin + per_reference); ++k)
      kept.push_back(hypotheses[ranked[k].second]);
  }
  return kept;
}
}  // namespace bin_picking
