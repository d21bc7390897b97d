// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <iterator>

#include "bin_picking_perception/common/parallel.hpp"
#include "stages.hpp"

namespace bin_picking
{
namespace
{
constexpr std::size_t GLANCE_POINTS = 20;
constexpr std::size_t BUNDLE = 64;

using Glimpse = std::pair<double, std::size_t>;  ///< minus the promise, and of which pose: the best is the least

template <typename Posed>
std::vector<Glimpse> glanceAtAll(const std::vector<Posed>& poses, const Glance& glance, const Executor& executor)
{
  std::vector<Glimpse> glimpses(poses.size());
  executor.forEachBundle(poses.size(), BUNDLE, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      glimpses[i] = {-glance.at(poses[i].T_camera_object), i};
  });
  return glimpses;
}

bool anyProposesMoreThan(std::size_t count, const std::vector<Hypothesis>& hypotheses)
{
  for (std::size_t i = count; i < hypotheses.size(); ++i)
    if (hypotheses[i].reference == hypotheses[i - count].reference)
      return true;
  return false;
}
}  // namespace

Glance::Glance(const PreparedScene& scene, const TrainedModel& model, const VerificationParameters& parameters)
    : scene_(scene), model_(model), parameters_(parameters), facing_(model, GLANCE_POINTS)
{}

double Glance::at(const Pose& T_camera_object) const
{
  // The pose of one reference point is off by about the distance of the points that voted.
  const double tolerance = model_.parameters.matching_leaf;
  return promise(gatherEvidence(facing_.at(T_camera_object), T_camera_object, scene_.grid, scene_.surroundings,
                                scene_.normals, tolerance, parameters_),
                 parameters_);
}

std::vector<Hypothesis> keepPromising(const std::vector<Hypothesis>& hypotheses, std::size_t per_reference,
                                      const Glance& glance, const Executor& executor)
{
  if (!anyProposesMoreThan(per_reference, hypotheses))
    return hypotheses;
  std::vector<Glimpse> ranked = glanceAtAll(hypotheses, glance, executor);
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

std::vector<Hypothetical> keepPromising(const std::vector<Hypothetical>& poses, double share, const Glance& glance,
                                        const Executor& executor)
{
  std::vector<Glimpse> ranked = glanceAtAll(poses, glance, executor);
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::size_t> chosen(static_cast<std::size_t>(std::ceil(share * static_cast<double>(poses.size()))));
  std::transform(ranked.begin(), ranked.begin() + static_cast<std::ptrdiff_t>(chosen.size()), chosen.begin(),
                 [](const auto& pose) { return pose.second; });
  std::sort(chosen.begin(), chosen.end());
  std::vector<Hypothetical> kept;
  kept.reserve(chosen.size());
  std::transform(chosen.begin(), chosen.end(), std::back_inserter(kept), [&](std::size_t i) { return poses[i]; });
  return kept;
}
}  // namespace bin_picking
