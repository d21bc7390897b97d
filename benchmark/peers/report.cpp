// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "report.hpp"

#include <pcl/pcl_config.h>
#include <cmath>
#include <fstream>
#include <opencv2/core/version.hpp>
#include <set>
#include <sstream>

#include "text_table.hpp"

namespace bin_picking::peers
{
namespace
{
constexpr double MILLI = 1000;
constexpr double MEGABYTE = 1 << 20;
constexpr double DEGREES = 180 / M_PI;

using Trials = std::vector<PlannedTrial>;
using Selection = std::vector<const PlannedTrial*>;

/// Of one program; of one part unless `part` is empty.
Selection select(const Trials& trials, std::size_t program, const std::string& part = "")
{
  Selection selection;
  for (const PlannedTrial& planned : trials)
    if (planned.trial.program == program && (part.empty() || planned.trial.part.name == part))
      selection.push_back(&planned);
  return selection;
}

std::string processor()
{
  std::ifstream file("/proc/cpuinfo");
  std::string line;
  while (std::getline(file, line))
    if (line.rfind("model name", 0) == 0)
      return line.substr(line.find(':') + 2);
  return "unknown processor";
}

std::string ratioText(const Spread& ratio) { return shortNumber(ratio.median); }

std::string loneTable(const Study& study)
{
  TextTable table({"program", "right before ICP", "right", "right < 0.02 d", "error mm", "deg", "match ms", "ICP ms",
                   "sum ms", "times ours", "training s", "training MB", "search MB"});
  const Selection ours = select(study.lone, 0);
  for (std::size_t p = 0; p < programs().size(); ++p)
  {
    const Selection trials = select(study.lone, p);
    if (trials.empty())
      continue;
    const LoneFigures f = loneFigures(trials, ours, study.shapes);
    table.add({programs()[p].name, f.shows_matches ? share(f.matched) : "-", share(f.found), share(f.exact),
               number(MILLI * f.translation.median, 2), number(DEGREES * f.rotation.median, 2),
               shortNumber(MILLI * f.match.median), shortNumber(MILLI * f.icp.median),
               shortNumber(MILLI * f.total.median), ratioText(f.ratio), shortNumber(f.training.median),
               shortNumber(f.training_memory.median / MEGABYTE), shortNumber(f.search_memory.median / MEGABYTE)});
  }
  return table.text();
}

std::string lonePartsTable(const Study& study)
{
  std::vector<std::string> header = {"part"};
  std::set<std::string> parts;
  for (const PlannedTrial& planned : study.lone)
    parts.insert(planned.trial.part.name);
  for (std::size_t p = 0; p < programs().size(); ++p)
    if (!select(study.lone, p).empty())
      for (const char* column : {" right", " ms", " training s"})
        header.push_back(programs()[p].name + column);
  TextTable table(header);
  for (const std::string& part : parts)
  {
    std::vector<std::string> row = {part};
    for (std::size_t p = 0; p < programs().size(); ++p)
    {
      if (select(study.lone, p).empty())
        continue;
      const LoneFigures f = loneFigures(select(study.lone, p, part), select(study.lone, 0, part), study.shapes);
      row.push_back(share(f.found));
      row.push_back(shortNumber(MILLI * f.total.median));
      row.push_back(shortNumber(f.training.median));
    }
    table.add(row);
  }
  return table.text();
}

/// One row per outcome; the exponents of growth below.
std::string growthTables(const Trials& trials, const PartShapes& shapes, bool of_model)
{
  TextTable table({"program", "model points", "scene points", "training s", "training MB", "match ms", "ICP ms",
                   "search MB", "right"});
  std::ostringstream exponents;
  for (std::size_t p = 0; p < programs().size(); ++p)
  {
    if (select(trials, p).empty())
      continue;
    std::vector<double> sizes;
    std::vector<double> training;
    std::vector<double> match;
    for (const PlannedTrial* planned : select(trials, p))
      for (std::size_t k = 0; k < planned->outcome.scenes.size(); ++k)
      {
        const TrainingOutcome& trained = *planned->outcome.training;
        const SceneOutcome& scene = planned->outcome.scenes[k];
        const FirstPose first = judgeFirst(scene.result, planned->trial.scenes[k], shapes.at(planned->trial.part.name));
        sizes.push_back(of_model ? trained.points : scene.result.scene_points);
        training.push_back(trained.seconds);
        match.push_back(scene.result.match_seconds);
        table.add({programs()[p].name, std::to_string(trained.points), std::to_string(scene.result.scene_points),
                   shortNumber(trained.seconds), shortNumber(trained.memory / MEGABYTE),
                   shortNumber(MILLI * match.back()), shortNumber(MILLI * scene.result.icp_seconds),
                   shortNumber(scene.memory / MEGABYTE), first.found ? "yes" : "no"});
      }
    exponents << "- " << programs()[p].name << ": ";
    if (of_model)
      exponents << "training time ~ points^" << number(growthExponent(sizes, training), 1) << ", ";
    exponents << "match time ~ points^" << number(growthExponent(sizes, match), 1) << "\n";
  }
  return table.text() + "\n" + exponents.str();
}

std::string binTable(const Study& study)
{
  std::vector<std::string> header = {"program"};
  for (const double level : EvaluationParameters().levels())
    header.push_back("recall >= " + number(level, 2) + " visible");
  for (const char* column : {"AP", "best right", "precision", "error mm", "deg", "ms a bin", "times ours"})
    header.push_back(column);
  TextTable table(header);
  for (std::size_t p = 0; p < programs().size(); ++p)
  {
    const Selection trials = select(study.bins, p);
    if (trials.empty())
      continue;
    const BinFigures f = binFigures(trials, select(study.bins, 0), study.bin_shapes);
    std::vector<std::string> row = {programs()[p].name};
    for (const RecallAtLevel& recall : f.evaluation.recall)
      row.push_back(number(recall.ratio.value(), 3) + " (" + share(recall.ratio) + ")");
    row.push_back(f.evaluation.average_precision ? number(*f.evaluation.average_precision, 3) : "-");
    row.push_back(f.evaluation.first.empty() ? "-" : share(f.evaluation.first.front().ratio));
    row.push_back(share(f.evaluation.precision));
    row.push_back(number(MILLI * f.evaluation.translation.median, 2));
    row.push_back(number(DEGREES * f.evaluation.rotation.median, 2));
    row.push_back(shortNumber(MILLI * f.seconds.median));
    row.push_back(ratioText(f.ratio));
    table.add(row);
  }
  return table.text();
}

std::string failures(const Study& study)
{
  std::ostringstream out;
  for (const Trials* trials : {&study.lone, &study.model_growth, &study.scene_growth, &study.bins})
    for (const PlannedTrial& planned : *trials)
      if (!planned.outcome.failure.empty())
        out << "- " << programs()[planned.trial.program].name << ", " << planned.trial.part.name << ", "
            << (planned.outcome.training ? "after " + std::to_string(planned.outcome.scenes.size()) + " of " +
                                               std::to_string(planned.trial.scenes.size()) + " scans"
                                         : std::string("in training"))
            << ": " << planned.outcome.failure << "\n";
  return out.str().empty() ? "None: every program answered every question.\n" : out.str();
}

std::string introduction(const Study& study)
{
  std::ostringstream out;
  out << "# Ours beside OpenCV and PCL\n\n";
  for (const std::string& word : study.command)
    out << (word == study.command.front() ? "`" : " ") << word;
  out << "`\n\nOpenCV " << CV_VERSION << " `cv::ppf_match_3d` with its ICP, PCL " << PCL_VERSION_PRETTY
      << " `PPFRegistration` with\n`IterativeClosestPointWithNormals`, and this package. " << processor()
      << ", one thread each.\n\n"
      << "Every program runs in a process of its own, on the same scans and the same normals, whose estimation is\n"
      << "outside of all times but those of `ours` (which takes the organized cloud and does everything itself).\n"
      << "Times are CPU time, medians. `times ours` is the median over the scans of a program's time by ours for the\n"
      << "same scan. d is the diameter of the part; ADD is the mean distance of corresponding surface points modulo "
         "the\n"
      << "part's symmetry. `right`: ADD below 0.1 d. Sampling: " << number(100 * study.step, 1)
      << " % of d for the peers and `ours, points only`;\n`ours` derives it from the part. Limit: "
      << number(study.limit, 0) << " s of CPU time for a training or a scan; what was not answered counts as wrong.\n\n"
      << "The peers as they are at their best: OpenCV gets clouds sampled in true cubes, lengths in millimetres,\n"
      << "thresholds for its clustering (0.05 d, 12 degrees) and its poses made rigid; PCL gets 31 angle bins, normals "
         "a\n"
      << "hair below unit length, clusters of 0.1 d and 12 degrees; both ICPs get only model points that the camera\n"
      << "sees and only the scene near the pose. None of this preparation is in their times.\n\n";
  return out.str();
}
}  // namespace

std::string toMarkdown(const Study& study)
{
  std::ostringstream out;
  out << introduction(study) << "## One part in the air\n\n"
      << loneTable(study) << "\nThe same by part (sum of match and ICP):\n\n"
      << lonePartsTable(study);
  if (!study.model_growth.empty())
    out << "\n## Growth with the size of the model\n\nOne scan of " << study.model_growth.front().trial.part.name
        << "; model and scene are sampled ever finer, ours too, coarser than\nit would do itself.\n\n"
        << growthTables(study.model_growth, study.shapes, true) << "\n## Growth with the size of the scene\n\n"
        << "One, two, four and more copies of the part in a scan, the same model. `ours` returns all of them, the\n"
        << "others one.\n\n"
        << growthTables(study.scene_growth, study.shapes, false);
  if (!study.bins.empty())
    out << "\n## Whole bins\n\nFull bins of a data set. What the peers propose is refined by their ICP and ranked and "
           "thinned by the same\nsimple depth check. Right: largest distance (MSSD) below 0.1 d.\n\n"
        << binTable(study);
  out << "\n## Not answered\n\n" << failures(study);
  return out.str();
}

nlohmann::json toJson(const Study& study)
{
  nlohmann::json json = {{"command", study.command}, {"step", study.step},   {"limit", study.limit},
                         {"processor", processor()}, {"opencv", CV_VERSION}, {"pcl", PCL_VERSION_PRETTY}};
  const std::vector<std::pair<const char*, const Trials*>> sections = {{"lone", &study.lone},
                                                                       {"model_growth", &study.model_growth},
                                                                       {"scene_growth", &study.scene_growth},
                                                                       {"bins", &study.bins}};
  for (const auto& [name, trials] : sections)
  {
    json[name] = nlohmann::json::array();
    for (const PlannedTrial& planned : *trials)
    {
      nlohmann::json entry = {{"program", programs()[planned.trial.program].key},
                              {"part", planned.trial.part.name},
                              {"step", planned.trial.step},
                              {"failure", planned.outcome.failure},
                              {"scans", nlohmann::json::array()},
                              {"outcomes", nlohmann::json::array()}};
      if (planned.outcome.training)
        entry["training"] = toJson(*planned.outcome.training);
      for (const EvaluationScene& scene : planned.trial.scenes)
        entry["scans"].push_back(toJson(scene));
      for (const SceneOutcome& outcome : planned.outcome.scenes)
        entry["outcomes"].push_back(toJson(outcome));
      json[name].push_back(entry);
    }
  }
  return json;
}
}  // namespace bin_picking::peers
