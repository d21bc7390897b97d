// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/matching/voting.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <mutex>

#include "bin_picking_perception/common/parallel.hpp"
#include "vote_caster.hpp"

namespace bin_picking
{
void VotingParameters::visit(ParameterVisitor& v)
{
  v.field({"reference_share", "", "share of the scene samples that vote; voting time is proportional to it", 0.001, 1},
          reference_share);
  v.field({"min_references", "", "at least so many reference points (or all samples)", 1, 100000}, min_references);
  v.field({"max_pair_distance", "",
           "reach of a reference point as a share of the diameter; less is faster and less specific", 0.1, 1},
          max_pair_distance);
  v.field({"weight", "", "W of Equation 8, for pairs of a low- and a high-curvature point (the paper: 2 to 8)", 1, 64},
          weight);
  v.field({"edge_weight", "",
           "votes of a pair of a reference point and a point where a face ends; faces look the same all over but for "
           "where they end. 0: edges do not vote, as in the paper",
           0, 64},
          edge_weight);
  v.field({"curvature_spread", "",
           "share of a curvature bin at either end from which the neighbouring bin is looked up too", 0, 0.5},
          curvature_spread);
  v.field({"curvature_wildcard", "", "points whose neighbourhood is cut off meet every curvature bin"},
          curvature_wildcard);
  v.field({"max_bucket", "", "longer entries of the table are skipped (planes, cylinders); 0 = none", 0, 10000000},
          max_bucket);
  v.field(
      {"max_votes", "",
       "about so many votes of a reference point at most: of its pairs every n-th counts, all over its neighbourhood. "
       "Bounds the time of planar parts; 0 = all",
       0, 100000000},
      max_votes);
  v.field({"skip_repeated", "", "count scene pairs of a reference point with equal feature and alpha once"},
          skip_repeated);
  v.field({"peaks_per_reference", "", "most poses that one reference point may propose", 1, 20}, peaks_per_reference);
  v.field({"min_peak_share", "", "further poses of a reference point need this share of its highest vote", 0, 1},
          min_peak_share);
  v.field({"sum_adjacent_angles", "", "count votes of two neighbouring steps of alpha together"}, sum_adjacent_angles);
}

std::vector<int> chooseReferences(const std::vector<int>& candidates, const VotingParameters& parameters)
{
  const auto count = static_cast<double>(candidates.size());
  const double wanted =
      std::min(count, std::max(parameters.reference_share * count, static_cast<double>(parameters.min_references)));
  std::vector<int> references;
  references.reserve(static_cast<std::size_t>(wanted) + 1);
  for (double next = 0; next < count && wanted > 0; next += count / wanted)
    references.push_back(candidates[static_cast<std::size_t>(next)]);
  return references;
}

namespace
{
/// Of the points of every cube the middle one in their order.
std::vector<int> middlesOfCubes(const std::vector<Eigen::Vector3f>& points, double edge)
{
  const auto scale = static_cast<float>(1 / edge);
  std::vector<std::pair<std::array<int, 3>, int>> members(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Eigen::Array3i cube = (points[i] * scale).array().floor().cast<int>();
    members[i] = {{cube.x(), cube.y(), cube.z()}, static_cast<int>(i)};
  }
  std::sort(members.begin(), members.end());
  std::vector<int> middles;
  for (std::size_t begin = 0, end = 0; begin < members.size(); begin = end)
  {
    while (end < members.size() && members[end].first == members[begin].first)
      ++end;
    middles.push_back(members[(begin + end) / 2].second);
  }
  std::sort(middles.begin(), middles.end());
  return middles;
}
}  // namespace

std::vector<int> spreadReferences(const std::vector<Eigen::Vector3f>& points, double leaf,
                                  const VotingParameters& parameters)
{
  const std::size_t wanted = std::min(points.size(), static_cast<std::size_t>(parameters.min_references));
  double edge = leaf / std::sqrt(parameters.reference_share);
  std::vector<int> references = middlesOfCubes(points, edge);
  for (; references.size() < wanted && edge > 0.5 * leaf; edge *= M_SQRT1_2)
    references = middlesOfCubes(points, edge * M_SQRT1_2);
  return references;
}

namespace
{
/// A pose with where it takes the part's middle, so that few of them need a look at their turn.
struct Placed
{
  Pose T_camera_object;
  Eigen::Vector3d center;
};

bool samePose(const Placed& a, const Placed& b, double diameter)
{
  constexpr double SAME_TRACE = 2.75517;  // 1 + 2 cos(0.5 rad), of the turn from one to the other
  return (a.center - b.center).squaredNorm() < 0.01 * diameter * diameter &&
         a.T_camera_object.linear().cwiseProduct(b.T_camera_object.linear()).sum() > SAME_TRACE;
}

/// The strongest peaks that are different poses (Equation 6).
std::vector<Hypothesis> extractPoses(const VotingScene& scene, std::size_t reference, Accumulator& accumulator)
{
  const TrainedModel& model = scene.model;
  const Pose T_camera_local =
      alignToLocalFrame(scene.points.points[reference], scene.points.normals[reference]).cast<double>().inverse();
  std::vector<Hypothesis> hypotheses;
  std::vector<Placed> known;
  accumulator.forEachPeak(
      scene.parameters.sum_adjacent_angles, scene.parameters.min_peak_share, [&](const Accumulator::Peak& peak) {
        const std::uint32_t m = model.table.references()[peak.row];
        const Pose T_local_object = alignToLocalFrame(model.points.points[m], model.points.normals[m]).cast<double>();
        const Pose T_camera_object = T_camera_local *
                                     Eigen::AngleAxisd(static_cast<double>(peak.alpha), Eigen::Vector3d::UnitX()) *
                                     T_local_object;
        const Placed placed{T_camera_object, T_camera_object * model.center};
        if (std::any_of(known.begin(), known.end(),
                        [&](const Placed& other) { return samePose(other, placed, model.diameter); }))
          return true;
        known.push_back(placed);
        hypotheses.push_back(
            {T_camera_object, static_cast<double>(peak.votes), static_cast<int>(reference), static_cast<int>(m)});
        return static_cast<int>(hypotheses.size()) < scene.parameters.peaks_per_reference;
      });
  return hypotheses;
}

/// Accumulators are large; threads take one and give it back.
class CasterPool
{
public:
  explicit CasterPool(const VotingScene& scene) : scene_(scene) {}

  std::unique_ptr<VoteCaster> take()
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (free_.empty())
      return std::make_unique<VoteCaster>(scene_);
    auto caster = std::move(free_.back());
    free_.pop_back();
    return caster;
  }
  void giveBack(std::unique_ptr<VoteCaster> caster)
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    free_.push_back(std::move(caster));
  }

private:
  const VotingScene& scene_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<VoteCaster>> free_;
};

struct BlockResult
{
  std::vector<Hypothesis> hypotheses;
  VotingStatistics statistics;
  bool skipped = false;
};
}  // namespace

VotingResult voteForPoses(const TrainedModel& model, const OrientedPoints& points,
                          const std::vector<std::uint8_t>& curvature_complete, const OrientedPoints& edges,
                          const std::vector<int>& references, const VotingParameters& parameters,
                          const Deadline& deadline, const Executor& executor)
{
  const VotingScene scene(model, points, curvature_complete, edges, parameters);
  CasterPool pool(scene);

  constexpr std::size_t BLOCK = 8;
  std::vector<BlockResult> blocks((references.size() + BLOCK - 1) / BLOCK);
  executor.forEach(blocks.size(), [&](std::size_t b) {
    BlockResult& result = blocks[b];
    result.skipped = deadline.passed();
    if (result.skipped)
      return;
    auto caster = pool.take();
    for (std::size_t r = b * BLOCK; r < std::min(references.size(), (b + 1) * BLOCK); ++r)
    {
      const auto reference = static_cast<std::size_t>(references[r]);
      caster->cast(reference, result.statistics);
      const auto poses = extractPoses(scene, reference, caster->accumulator());
      result.hypotheses.insert(result.hypotheses.end(), poses.begin(), poses.end());
    }
    pool.giveBack(std::move(caster));
  });

  VotingResult result;
  for (const auto& block : blocks)
  {
    result.hypotheses.insert(result.hypotheses.end(), block.hypotheses.begin(), block.hypotheses.end());
    result.statistics.references += block.statistics.references;
    result.statistics.pairs += block.statistics.pairs;
    result.statistics.votes += block.statistics.votes;
    result.partial = result.partial || block.skipped;
  }
  return result;
}
}  // namespace bin_picking
