// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/evaluation_summary.hpp"

#include <algorithm>
#include <map>

namespace bin_picking
{
namespace
{
constexpr int FIRST[] = {1, 3, 5};

/// What is counted for one part, or for all (an empty name).
class Tally
{
public:
  Tally(std::string part, const EvaluationParameters& parameters) : part_(std::move(part)), levels_(parameters.levels())
  {
    figures_.part = part_;
    for (const double level : levels_)
      figures_.recall.push_back({level, {}});
    for (const int first : FIRST)
      figures_.first.push_back({first, {}});
  }

  void add(const JudgedScene& scene)
  {
    if (std::none_of(scene.scene.parts.begin(), scene.scene.parts.end(), [&](const auto& p) { return concerns(p); }))
      return;
    ++figures_.scenes;
    const bool has_pickable = countInstances(scene);
    countEstimates(scene);
    countTested(scene);
    if (has_pickable)
      countFirst(scene);
    for (const std::string& part : scene.scene.parts)
      if (concerns(part))
        countFalseInEmpty(scene, part);
  }

  EvaluationFigures figures() const
  {
    EvaluationFigures figures = figures_;
    figures.translation = spread(translations_);
    figures.rotation = spread(rotations_);
    figures.mean_distance = spread(mean_distances_);
    figures.average_precision = averagePrecision(outcomes_, figures.pickable);
    figures.tested = calibration(tested_);
    figures.returned = calibration(returned_);
    return figures;
  }

private:
  bool concerns(const std::string& part) const { return part_.empty() || part == part_; }

  /// \return whether one is pickable
  bool countInstances(const JudgedScene& scene)
  {
    const int pickable_before = figures_.pickable;
    for (std::size_t i = 0; i < scene.scene.instances.size(); ++i)
    {
      const TrueInstance& instance = scene.scene.instances[i];
      if (!concerns(instance.part))
        continue;
      ++figures_.instances;
      for (RecallAtLevel& recall : figures_.recall)
        if (instance.visible_fraction >= recall.level)
        {
          recall.ratio.count(scene.found_by[i].has_value());
          recall.turn_known.count(isFoundWithTurn(scene, i));
        }
      if (instance.visible_fraction < levels_.front())
        continue;
      ++figures_.pickable;
      figures_.mean_distance_recall.count(scene.found_by_mean_distance[i]);
    }
    return figures_.pickable > pickable_before;
  }

  static bool isFoundWithTurn(const JudgedScene& scene, std::size_t instance)
  {
    const std::optional<std::size_t>& found_by = scene.found_by[instance];
    return found_by && !scene.estimates[*found_by].estimate.undetermined_turn;
  }

  void countEstimates(const JudgedScene& scene)
  {
    for (const JudgedEstimate& judged : scene.estimates)
    {
      if (!concerns(judged.estimate.part))
        continue;
      figures_.precision.count(judged.isHit());
      if (judged.estimate.undetermined_turn)
        figures_.undetermined.count(judged.isHit());
      figures_.right += judged.verdict == Verdict::Right;
      figures_.hidden += judged.verdict == Verdict::Hidden;
      figures_.duplicates += judged.verdict == Verdict::Duplicate;
      figures_.wrong += judged.verdict == Verdict::Wrong;
      if (judged.verdict != Verdict::Hidden)
        outcomes_.push_back({judged.estimate.score, judged.verdict == Verdict::Right});
      if (!judged.isHit())
        continue;
      translations_.push_back(judged.error.translation);
      rotations_.push_back(judged.error.rotation);
      mean_distances_.push_back(judged.mean_distance);
    }
  }

  void countTested(const JudgedScene& scene)
  {
    for (const TestedPose& pose : scene.tested)
      if (concerns(pose.part))
      {
        tested_.push_back({pose.score, pose.right});
        if (pose.accepted)
          returned_.push_back(tested_.back());
      }
  }

  void countFirst(const JudgedScene& scene)
  {
    for (FirstPrecision& first : figures_.first)
    {
      int returned = 0;
      for (const JudgedEstimate& judged : scene.estimates)
        if (concerns(judged.estimate.part) && returned < first.first)
        {
          first.ratio.count(judged.isHit());
          ++returned;
        }
      if (returned == 0)
        first.ratio.count(false);  // there was something to pick, and the robot went away empty
    }
  }

  void countFalseInEmpty(const JudgedScene& scene, const std::string& part)
  {
    const auto& instances = scene.scene.instances;
    if (std::any_of(instances.begin(), instances.end(), [&](const TrueInstance& i) { return i.part == part; }))
      return;
    const auto found = std::count_if(scene.estimates.begin(), scene.estimates.end(),
                                     [&](const JudgedEstimate& e) { return e.estimate.part == part; });
    figures_.empty_scenes.count(found > 0);
    figures_.false_in_empty += static_cast<int>(found);
  }

  std::string part_;
  std::vector<double> levels_;
  EvaluationFigures figures_;
  std::vector<ScoredOutcome> outcomes_;
  std::vector<ScoredOutcome> tested_;
  std::vector<ScoredOutcome> returned_;
  std::vector<double> translations_;
  std::vector<double> rotations_;
  std::vector<double> mean_distances_;
};

EvaluationFigures tally(const std::vector<JudgedScene>& scenes, const std::string& part,
                        const EvaluationParameters& parameters)
{
  Tally tally(part, parameters);
  for (const JudgedScene& scene : scenes)
    tally.add(scene);
  return tally.figures();
}

/// Mean over the parts that have a value.
std::optional<double> meanAveragePrecision(const std::vector<EvaluationFigures>& parts)
{
  double sum = 0;
  int count = 0;
  for (const EvaluationFigures& part : parts)
    if (part.average_precision)
    {
      sum += *part.average_precision;
      ++count;
    }
  return count > 0 ? std::optional<double>(sum / count) : std::nullopt;
}

void summarizeTimes(const std::vector<JudgedScene>& scenes, EvaluationSummary& summary)
{
  std::vector<double> totals;
  std::vector<std::string> order;
  std::map<std::string, std::vector<double>> stages;
  for (const JudgedScene& scene : scenes)
    for (const RunTime& run : scene.runs)
    {
      totals.push_back(run.total);
      for (const StageTime& time : run.stages)
      {
        if (stages.count(time.stage) == 0)
          order.push_back(time.stage);
        stages[time.stage].push_back(time.seconds);
      }
    }
  summary.total = spread(totals);
  for (const std::string& stage : order)
    summary.stages.push_back({stage, spread(stages[stage])});
}
}  // namespace

EvaluationSummary summarize(const std::vector<JudgedScene>& scenes, const std::vector<std::string>& parts,
                            const EvaluationParameters& parameters)
{
  EvaluationSummary summary;
  for (const std::string& part : parts)
    summary.parts.push_back(tally(scenes, part, parameters));
  summary.all = tally(scenes, "", parameters);
  summary.all.average_precision = meanAveragePrecision(summary.parts);
  summarizeTimes(scenes, summary);
  return summary;
}

std::vector<std::size_t> missedInstances(const JudgedScene& scene, double lowest_level)
{
  std::vector<std::size_t> missed;
  for (std::size_t i = 0; i < scene.scene.instances.size(); ++i)
    if (!scene.found_by[i] && scene.scene.instances[i].visible_fraction >= lowest_level)
      missed.push_back(i);
  return missed;
}
}  // namespace bin_picking
