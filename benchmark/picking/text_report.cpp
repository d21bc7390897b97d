// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <sstream>

#include "bin_picking_perception/common/figures.hpp"
#include "bin_picking_perception/evaluation/statistics.hpp"
#include "report.hpp"
#include "terminal.hpp"

namespace bin_picking::picking
{
namespace
{
using simulation::GripVerdict;

std::vector<Attempt> attemptsOf(const PartStudy& part)
{
  std::vector<Attempt> attempts;
  for (const Emptying& bin : part.bins)
    attempts.insert(attempts.end(), bin.attempts.begin(), bin.attempts.end());
  return attempts;
}

std::vector<double> secondsOf(const PartStudy& part, std::vector<double> Emptying::*seconds)
{
  std::vector<double> all;
  for (const Emptying& bin : part.bins)
    all.insert(all.end(), (bin.*seconds).begin(), (bin.*seconds).end());
  return all;
}

std::string timeText(const PartStudy& part, std::vector<double> Emptying::*seconds)
{
  const Spread times = spread(secondsOf(part, seconds));
  return times.count == 0 ? "-" : roundedText(1000 * times.median, 1) + " / " + roundedText(1000 * times.p95, 1);
}

Ratio successes(const std::vector<Attempt>& attempts)
{
  Ratio ratio;
  for (const Attempt& attempt : attempts)
    ratio.count(attempt.succeeded());
  return ratio;
}

std::string percent(double share) { return roundedText(100 * share, 1); }

std::string ratioText(const Ratio& ratio)
{
  if (ratio.total == 0)
    return "-";
  const Interval interval = ratio.interval();
  return percent(ratio.value()) + " % [" + percent(interval.low) + ", " + percent(interval.high) + "]";
}

int shakesOf(const PartStudy& part)
{
  int shakes = 0;
  for (const Emptying& bin : part.bins)
    shakes += bin.shakes;
  return shakes;
}

int leftIn(const PartStudy& part)
{
  int left = 0;
  for (const Emptying& bin : part.bins)
    for (const auto& entry : bin.left)
      left += entry.second;
  return left;
}

void writeTable(std::ostream& out, const Study& study)
{
  out << "| part | bins | picks | taken | success, 95 % interval | collisions called free | shakes | parts left | "
         "detection, ms "
         "| grasps, ms | judge, ms |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const PartStudy& part : study.parts)
  {
    const std::vector<Attempt> attempts = attemptsOf(part);
    const Ratio taken = successes(attempts);
    const auto called_free =
        std::count_if(attempts.begin(), attempts.end(), [](const Attempt& a) { return a.called_free; });
    out << "| " << part.name << " | " << part.bins.size() << " | " << taken.total << " | " << taken.hits << " | "
        << ratioText(taken) << " | " << called_free << " | " << shakesOf(part) << " | " << leftIn(part) << " | "
        << timeText(part, &Emptying::detection_seconds) << " | " << timeText(part, &Emptying::planning_seconds) << " | "
        << timeText(part, &Emptying::judging_seconds) << " |\n";
  }
  out << "\nTimes: median / 95th percentile per cloud or grip. Shakes: nothing was allowed, the parts fell "
         "anew. Left: parts in the bin at the end.\n";
}

void writeCounts(std::ostream& out, const std::map<std::string, int>& counts)
{
  std::vector<std::pair<std::string, int>> sorted(counts.begin(), counts.end());
  std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  for (const auto& [cause, count] : sorted)
    out << "- " << count << " x " << cause << "\n";
}

void writeDetails(std::ostream& out, const PartStudy& part)
{
  std::map<std::string, int> causes;
  std::map<std::string, int> left;
  for (const Attempt& attempt : attemptsOf(part))
    ++causes[causeOf(attempt)];
  for (const Emptying& bin : part.bins)
    for (const auto& [cause, count] : bin.left)
      left[cause] += count;
  out << "\n## " << part.name << "\n\nOutcomes:\n\n";
  writeCounts(out, causes);
  if (!left.empty())
  {
    out << "\nLeft in the bins:\n\n";
    writeCounts(out, left);
  }
  out << "\nFailures:\n\n";
  for (const Attempt& a : attemptsOf(part))
    if (!a.succeeded())
      out << "- seed " << a.seed << ", cloud " << a.cloud << ", " << a.part << "/" << a.grasp << ", tilt "
          << roundedText(a.tilt * 180 / M_PI, 0) << " deg, pose off by " << roundedText(1000 * a.center_error, 1)
          << " mm and " << roundedText(a.rotation_error * 180 / M_PI, 1) << " deg"
          << (a.called_free ? ", **called free**" : "") << ": " << a.verdict.what << "\n";
}
}  // namespace

std::string causeOf(const Attempt& attempt)
{
  const GripVerdict& verdict = attempt.verdict;
  if (attempt.another_part)
    return "another part";
  if (verdict.outcome == GripVerdict::Outcome::Taken)
    return "taken";
  if (verdict.outcome == GripVerdict::Outcome::Missed)
    return "missed";
  const std::string who = verdict.body == HELD_PART ? HELD_PART : "gripper";
  return std::string(toString(verdict.stage)) + ": " + who + " against " + toString(verdict.obstacle);
}

std::string toText(const Study& study)
{
  std::ostringstream out;
  out << "# Picking in the virtual cell\n\nCommand:";
  for (const std::string& word : study.command)
    out << " " << word;
  out << "\n\n"
      << (study.version.empty() ? "" : "Version " + study.version + ". ") << "Sensor " << study.sensor << ", gripper "
      << study.gripper << ", poses " << (study.truth ? "true" : "detected") << ".\n\n";
  writeTable(out, study);
  for (const PartStudy& part : study.parts)
    writeDetails(out, part);
  return out.str();
}
}  // namespace bin_picking::picking
