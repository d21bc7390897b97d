// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cmath>
#include <iomanip>

#include "bin_picking_perception/common/figures.hpp"
#include "evaluation_report.hpp"
#include "terminal.hpp"

namespace bin_picking::tools
{
namespace
{
constexpr double DEGREES = 180 / M_PI;
constexpr int CELL = 9;

std::string number(double value, int digits) { return std::isnan(value) ? "-" : roundedText(value, digits); }

std::string percent(double share) { return std::isnan(share) ? "-" : roundedText(100 * share, 1) + "%"; }

std::string levelName(double level) { return roundedText(100 * level, 0) + "%"; }

class Table
{
public:
  Table(std::ostream& out, const EvaluationSummary& summary) : out_(out)
  {
    for (const EvaluationFigures& part : summary.parts)
      name_width_ = std::max(name_width_, static_cast<int>(part.part.size()));
    out_ << std::left << std::setw(name_width_) << "part" << std::right;
    cell("parts");
    for (const RecallAtLevel& recall : summary.all.recall)
      cell("found" + levelName(recall.level));
    cell("right");
    for (const FirstPrecision& first : summary.all.first)
      cell("first " + std::to_string(first.first));
    for (const char* title : {"AP", "in empty", "mm", "deg", "ADD-S mm"})
      cell(title);
    out_ << "\n";
  }

  void row(const EvaluationFigures& f)
  {
    out_ << std::left << std::setw(name_width_) << (f.part.empty() ? "all" : f.part) << std::right;
    cell(std::to_string(f.pickable));
    for (const RecallAtLevel& recall : f.recall)
      cell(percent(recall.ratio.value()));
    cell(percent(f.precision.value()));
    for (const FirstPrecision& first : f.first)
      cell(percent(first.ratio.value()));
    cell(percent(f.average_precision.value_or(std::nan(""))));
    cell(f.empty_scenes.total > 0 ? std::to_string(f.false_in_empty) : "-");
    cell(number(f.translation.median * 1000, 2));
    cell(number(f.rotation.median * DEGREES, 2));
    cell(number(f.mean_distance.median * 1000, 2));
    out_ << "\n";
  }

private:
  void cell(const std::string& text) { out_ << " " << std::setw(CELL) << text; }

  std::ostream& out_;
  int name_width_ = 4;
};

void printRatio(std::ostream& out, const std::string& name, const Ratio& ratio)
{
  if (ratio.total == 0)
    return;
  const Interval interval = ratio.interval();
  out << "  " << std::left << std::setw(34) << name << std::right << std::setw(7) << percent(ratio.value()) << "  "
      << ratio.hits << " of " << ratio.total << ", 95 % interval " << roundedText(100 * interval.low, 0) << " to "
      << roundedText(100 * interval.high, 0) << " %\n";
}

/// Parts whose poses leave a turn open: how many do, and what is found without them.
void printOpenTurns(std::ostream& out, const EvaluationFigures& f)
{
  if (f.undetermined.total == 0)
    return;
  out << (f.part.empty() ? "  all" : "  " + f.part) << ", some of whose poses leave a turn open\n";
  printRatio(out, "  right, of those with an open turn", f.undetermined);
  for (const RecallAtLevel& recall : f.recall)
    printRatio(out, "  found with their turn, " + levelName(recall.level), recall.turn_known);
}

/// Only the tenths that have poses.
void printCalibration(std::ostream& out, const Calibration& tested, const Calibration& returned)
{
  out << "\nscore against truth of " << tested.count << " poses that were tested in full: Brier score "
      << roundedText(tested.brier_score, 3) << ", expected calibration error " << percent(tested.expected_error)
      << "\n  score          tested   mean   right  95 % interval   returned   right\n";
  for (std::size_t k = 0; k < tested.tenths.size(); ++k)
  {
    const CalibrationBin& tenth = tested.tenths[k];
    if (tenth.right.total == 0)
      continue;
    const double low = static_cast<double>(k) / 10;
    const Interval interval = tenth.right.interval();
    out << "  " << roundedText(low, 1) << " to " << roundedText(low + 0.1, 1) << std::setw(11) << tenth.right.total
        << std::setw(7) << roundedText(tenth.mean_score, 2) << std::setw(8) << percent(tenth.right.value())
        << std::setw(6) << roundedText(100 * interval.low, 0) << " to " << std::setw(3)
        << roundedText(100 * interval.high, 0) << " %" << std::setw(11) << returned.tenths[k].right.total
        << std::setw(8) << percent(returned.tenths[k].right.value()) << "\n";
  }
}

void printSpread(std::ostream& out, const std::string& name, const Spread& spread, double scale,
                 const std::string& unit)
{
  if (spread.count > 0)
    out << "  " << std::left << std::setw(34) << name << std::right << std::setw(7)
        << roundedText(spread.median * scale, 2) << " " << unit << ", 95 % below " << roundedText(spread.p95 * scale, 2)
        << " " << unit << "\n";
}
}  // namespace

void print(std::ostream& out, const EvaluationSummary& summary)
{
  const EvaluationFigures& all = summary.all;
  Table table(out, summary);
  for (const EvaluationFigures& part : summary.parts)
    table.row(part);
  if (summary.parts.size() > 1)
    table.row(all);
  out << "\n";
  if (!all.first.empty())
    printRatio(out, "the best pose of a scene is right", all.first.front().ratio);
  for (const RecallAtLevel& recall : all.recall)
    printRatio(out, "found, of those " + levelName(recall.level) + " visible", recall.ratio);
  printRatio(out, "right, of all poses returned", all.precision);
  for (const EvaluationFigures& part : summary.parts)
    printOpenTurns(out, part);
  if (summary.parts.size() > 1)
    printOpenTurns(out, all);
  printRatio(out, "empty bins with a false find", all.empty_scenes);
  printSpread(out, "off in position, median", all.translation, 1000, "mm");
  printSpread(out, "off in rotation, median", all.rotation, DEGREES, "deg");
  printSpread(out, "time per scene, median", summary.total, 1000, "ms");
  for (const StageSpread& stage : summary.stages)
    printSpread(out, "  " + stage.stage, stage.seconds, 1000, "ms");
  if (all.tested.count > 0)
    printCalibration(out, all.tested, all.returned);
}
}  // namespace bin_picking::tools
