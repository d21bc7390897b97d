// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/html_report.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <tuple>

#include "bin_picking_perception/common/error.hpp"
#include "html_calibration.hpp"
#include "html_parts.hpp"
#include "html_scene_card.hpp"

namespace bin_picking
{
namespace
{
std::string ofText(const Ratio& ratio) { return std::to_string(ratio.hits) + " of " + std::to_string(ratio.total); }

std::string levelText(double level) { return decimal(100 * level, 0) + " %"; }

std::string styleLeft(double share) { return "left:" + decimal(100 * share, 1) + "%"; }

class Page
{
public:
  explicit Page(const EvaluationReport& report)
      : report_(report), all_(report.summary.all), lowest_level_(report.parameters.levels().front())
  {}

  std::string html()
  {
    out_ << "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         << "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>Evaluation: "
         << escaped(report_.title) << "</title>\n<style>" << REPORT_STYLE << "</style>\n</head>\n<body>\n<main>\n";
    writeHead();
    writeTiles();
    writeParts();
    out_ << calibrationSection(all_.tested, all_.returned);
    writeStages();
    writeScenes();
    writeDefinitions();
    out_ << "</main>\n<script>" << REPORT_SCRIPT << "</script>\n</body>\n</html>\n";
    return out_.str();
  }

private:
  void writeHead()
  {
    out_ << "<h1>" << escaped(report_.title) << "</h1>\n<p class=\"details\">" << all_.scenes << " scenes, "
         << all_.instances << " parts in them, " << all_.pickable << " at least " << levelText(lowest_level_)
         << " visible; " << all_.precision.total << " poses returned";
    for (const auto& [name, value] : report_.details)
      out_ << " · " << escaped(name) << " <b>" << escaped(value) << "</b>";
    out_ << "</p>\n";
  }

  void ratioTile(const std::string& name, const Ratio& ratio)
  {
    out_ << "<div class=\"tile\"><div class=\"name\">" << name << "</div><div class=\"value\">"
         << percent(ratio.value()) << "</div>";
    if (ratio.total > 0)
    {
      const Interval interval = ratio.interval();
      out_ << "<div class=\"track\"><i style=\"" << styleLeft(interval.low)
           << ";right:" << decimal(100 * (1 - interval.high), 1) << "%\"></i><b style=\"" << styleLeft(ratio.value())
           << "\"></b></div><div class=\"note\">" << ofText(ratio) << " (" << intervalText(ratio) << ")"
           << "</div>";
    }
    out_ << "</div>\n";
  }

  void valueTile(const std::string& name, const std::string& value, const std::string& note)
  {
    out_ << "<div class=\"tile\"><div class=\"name\">" << name << "</div><div class=\"value\">" << value
         << "</div><div class=\"note\">" << note << "</div></div>\n";
  }

  /// \param scale from SI to the unit
  void spreadTile(const std::string& name, const Spread& spread, double scale, int digits, const std::string& unit)
  {
    if (spread.count > 0)
      valueTile(name, decimal(spread.median * scale, digits) + " " + unit,
                "median; 95 % below " + decimal(spread.p95 * scale, digits) + " " + unit);
  }

  void writeTiles()
  {
    out_ << "<div class=\"tiles\">\n";
    for (const FirstPrecision& first : all_.first)
      if (first.first == 1)
        ratioTile("Best pose of a scene is right", first.ratio);
    for (const RecallAtLevel& recall : all_.recall)
      ratioTile("Found, of those " + levelText(recall.level) + " visible", recall.ratio);
    ratioTile("Right, of all poses returned", all_.precision);
    writeTurnTiles();
    if (all_.average_precision)
      valueTile("Average precision", percent(*all_.average_precision),
                report_.summary.parts.size() > 1 ? "mean over the parts" : "area under precision over recall");
    if (all_.empty_scenes.total > 0)
      ratioTile("Empty bins with a false find", all_.empty_scenes);
    spreadTile("Off in position", all_.translation, 1000, 2, "mm");
    spreadTile("Off in rotation", all_.rotation, 180 / M_PI, 2, "°");
    spreadTile("Time per scene", report_.summary.total, 1000, 0, "ms");
    out_ << "</div>\n";
  }

  /// What of the above holds for poses that leave a turn open, and what without them.
  void writeTurnTiles()
  {
    if (all_.undetermined.total == 0)
      return;
    ratioTile("Right, of poses with an open turn", all_.undetermined);
    for (const RecallAtLevel& recall : all_.recall)
      ratioTile("Found with their turn, of those " + levelText(recall.level) + " visible", recall.turn_known);
  }

  void ratioCell(const Ratio& ratio)
  {
    out_ << "<td title=\"" << ofText(ratio) << "\">" << percent(ratio.value()) << "<small>" << intervalText(ratio)
         << "</small></td>";
  }

  void spreadCell(const Spread& spread, double scale)
  {
    out_ << "<td>" << decimal(spread.median * scale, 2) << "<small>" << decimal(spread.p95 * scale, 2)
         << "</small></td>";
  }

  void writeRow(const EvaluationFigures& f)
  {
    out_ << (f.part.empty() ? "<tr class=\"all\"><td>all" : "<tr><td>" + escaped(f.part)) << "</td><td>" << f.scenes
         << "</td><td>" << f.pickable << "<small>of " << f.instances << "</small></td>";
    for (const RecallAtLevel& recall : f.recall)
      ratioCell(recall.ratio);
    if (all_.undetermined.total > 0)
      for (const RecallAtLevel& recall : f.recall)
        ratioCell(recall.turn_known);
    ratioCell(f.precision);
    for (const FirstPrecision& first : f.first)
      ratioCell(first.ratio);
    out_ << "<td>" << percent(f.average_precision.value_or(std::nan(""))) << "</td><td>"
         << (f.empty_scenes.total > 0 ? std::to_string(f.false_in_empty) : "–") << "<small>in " << f.empty_scenes.total
         << "</small></td>";
    spreadCell(f.translation, 1000);
    spreadCell(f.rotation, 180 / M_PI);
    spreadCell(f.mean_distance, 1000);
    ratioCell(f.mean_distance_recall);
    out_ << "</tr>\n";
  }

  void writeParts()
  {
    out_ << "<h2>Parts</h2>\n<div class=\"panel\"><table>\n<tr><th>part</th><th>scenes</th><th>to be found</th>";
    for (const RecallAtLevel& recall : all_.recall)
      out_ << "<th>found, " << levelText(recall.level) << " visible</th>";
    if (all_.undetermined.total > 0)
      for (const RecallAtLevel& recall : all_.recall)
        out_ << "<th>found with their turn, " << levelText(recall.level) << " visible</th>";
    out_ << "<th>right of all</th>";
    for (const FirstPrecision& first : all_.first)
      out_ << "<th>right of first " << first.first << "</th>";
    out_ << "<th>average precision</th><th>false in empty bins</th><th>position, mm<br>median, 95 %</th>"
         << "<th>rotation, °<br>median, 95 %</th><th>ADD-S, mm<br>median, 95 %</th><th>found by ADD-S</th></tr>\n";
    for (const EvaluationFigures& part : report_.summary.parts)
      writeRow(part);
    if (report_.summary.parts.size() > 1)
      writeRow(all_);
    out_ << "</table></div>\n";
  }

  void writeStages()
  {
    if (report_.summary.stages.empty())
      return;
    double longest = 0;
    for (const StageSpread& stage : report_.summary.stages)
      longest = std::max(longest, stage.seconds.p95);
    out_ << "<h2>Time per stage <span class=\"soft\">median, 95 %</span></h2>\n<div class=\"panel stages\">\n";
    for (const StageSpread& stage : report_.summary.stages)
    {
      const auto width = [&](double seconds) { return decimal(longest > 0 ? 100 * seconds / longest : 0, 1) + "%"; };
      out_ << "<span>" << escaped(stage.stage)
           << "</span><span class=\"bar\"><i style=\"width:" << width(stage.seconds.p95)
           << "\"></i><b style=\"width:" << width(stage.seconds.median) << "\"></b></span><span class=\"time\">"
           << decimal(stage.seconds.median * 1000, 1) << ", " << decimal(stage.seconds.p95 * 1000, 1) << " ms</span>\n";
    }
    out_ << "</div>\n";
  }

  void writeFilter(const std::string& kind, const std::string& text)
  {
    const auto has = [&](const JudgedScene& scene) {
      return (" " + sceneKinds(countsOf(scene, lowest_level_)) + " ").find(" " + kind + " ") != std::string::npos;
    };
    const auto count = kind == "all" ? static_cast<std::ptrdiff_t>(report_.scenes.size())
                                     : std::count_if(report_.scenes.begin(), report_.scenes.end(), has);
    out_ << "<button data-show=\"" << kind << "\" aria-pressed=\"" << (kind == "all" ? "true" : "false") << "\">"
         << text << " " << count << "</button>\n";
  }

  /// Those with wrong finds first, then those with misses.
  std::vector<std::size_t> worstFirst() const
  {
    std::vector<std::size_t> order(report_.scenes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto badness = [&](std::size_t k) {
      const SceneCounts counts = countsOf(report_.scenes[k], lowest_level_);
      return std::make_tuple(counts.wrong, counts.duplicates, counts.missed);
    };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return badness(a) > badness(b); });
    return order;
  }

  void writeScenes()
  {
    out_ << "<h2>Scenes</h2>\n<div class=\"filters\">\n";
    writeFilter("all", "All");
    writeFilter("flawed", "With a flaw");
    writeFilter("wrong", "Wrong");
    writeFilter("duplicate", "Duplicate");
    writeFilter("missed", "Missed");
    writeFilter("flawless", "Flawless");
    out_ << "<span class=\"legend\"><span><i class=\"key right\"></i>right</span>"
         << "<span><i class=\"key hidden\"></i>right, but hidden</span>"
         << "<span><i class=\"key wrong\"></i>wrong</span>"
         << "<span><i class=\"key duplicate\"></i>duplicate</span>"
         << "<span><i class=\"key missed\"></i>missed</span></span></div>\n<div class=\"scenes\">\n";
    for (const std::size_t k : worstFirst())
      out_ << sceneCard(report_.scenes[k], report_.pictures[k], lowest_level_);
    out_ << "</div>\n";
  }

  void writeDefinitions()
  {
    out_ << "<h2>What the figures mean</h2>\n<dl>\n<dt>right</dt><dd>No point of the part is off by "
         << percent(report_.parameters.max_error_share)
         << " of its diameter or more (MSSD, symmetry considered). Best score first, each pose takes the nearest free "
            "part of its kind; a second one there is a duplicate, and wrong.</dd>\n"
         << "<dt>open turn</dt><dd>A pose may say that its turn about an axis is not known. It is right if it is so "
            "after the turn that fits best, and counts so in every figure but those of parts found with their "
            "turn.</dd>\n"
         << "<dt>right, but hidden</dt><dd>The part is less than " << levelText(lowest_level_)
         << " visible: nobody asks for it. Counts as right among the poses returned, and not at all in the average "
            "precision.</dd>\n"
         << "<dt>right of first k</dt><dd>Over scenes in which a part is visible enough. Where nothing was returned, "
            "that "
            "is one miss.</dd>\n"
         << "<dt>average precision</dt><dd>Area under the precision over the recall, scores pooled over all "
            "scenes.</dd>\n"
         << "<dt>score against truth</dt><dd>Of all poses that were tested in full, the rejected ones too; right if it "
            "hits any part of its kind. Brier score: mean square of score less outcome (1 or 0); expected calibration "
            "error: by how much a tenth's mean score is off its share of right poses, mean over the poses.</dd>\n"
         << "<dt>95 % sure</dt><dd>Wilson interval: where the true share lies, given how few were "
            "counted.</dd>\n</dl>\n";
  }

  const EvaluationReport& report_;
  const EvaluationFigures& all_;
  double lowest_level_;
  std::ostringstream out_;
};
}  // namespace

std::string htmlReport(const EvaluationReport& report)
{
  if (report.pictures.size() != report.scenes.size())
    throw ParameterError("The report has " + std::to_string(report.pictures.size()) + " pictures of " +
                         std::to_string(report.scenes.size()) + " scenes; each scene needs its own.");
  return Page(report).html();
}
}  // namespace bin_picking
