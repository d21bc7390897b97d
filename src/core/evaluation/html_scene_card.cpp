// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "html_scene_card.hpp"

#include <algorithm>
#include <sstream>

#include "bin_picking_perception/evaluation/evaluation_summary.hpp"
#include "html_parts.hpp"

namespace bin_picking
{
namespace
{
/// A sign beside the colour, for those who do not see it.
const char* verdictSign(Verdict verdict)
{
  switch (verdict)
  {
    case Verdict::Right:
    case Verdict::Hidden:
      return "✓";
    case Verdict::Duplicate:
      return "⧉";
    default:
      return "✗";
  }
}

class Card
{
public:
  Card(const JudgedScene& scene, const ScenePicture& picture, double lowest_level)
      : scene_(scene),
        picture_(picture),
        counts_(countsOf(scene, lowest_level)),
        missed_(missedInstances(scene, lowest_level))
  {}

  std::string html()
  {
    out_ << "<article class=\"scene\" data-has=\"" << sceneKinds(counts_) << "\">\n<header><b>"
         << escaped(scene_.scene.name) << "</b>";
    if (scene_.scene.parts.size() == 1)
      out_ << "<span class=\"soft\">" << escaped(scene_.scene.parts[0]) << "</span>";
    if (!scene_.runs.empty())
      out_ << "<span class=\"soft\">" << decimal(1000 * medianSeconds(), 0) << " ms</span>";
    out_ << "<span class=\"chips\">";
    chip(counts_.hits, "✓", "right");
    chip(counts_.wrong, "✗", "wrong");
    chip(counts_.duplicates, "⧉", "duplicate");
    chip(counts_.missed, "○", "missed");
    out_ << "</span></header>\n";
    writePicture();
    writeFlaws();
    writeHits();
    out_ << "</article>\n";
    return out_.str();
  }

private:
  double medianSeconds() const
  {
    std::vector<double> seconds;
    for (const RunTime& run : scene_.runs)
      seconds.push_back(run.total);
    return spread(seconds).median;
  }

  void chip(int count, const char* sign, const char* kind)
  {
    if (count > 0)
      out_ << "<span class=\"" << kind << "\" title=\"" << count << " " << kind << "\">" << sign << " " << count
           << "</span>";
  }

  void writePicture()
  {
    out_ << "<div class=\"picture\"><img loading=\"lazy\" alt=\"depth picture of " << escaped(scene_.scene.name)
         << "\" width=\"" << picture_.width << "\" height=\"" << picture_.height << "\" src=\"data:image/jpeg;base64,"
         << base64(picture_.jpeg) << "\">\n<svg viewBox=\"0 0 " << picture_.width << " " << picture_.height << "\">\n";
    for (const std::size_t i : missed_)
      writeMark(picture_.instances[i], "i" + std::to_string(i), "missed", missedText(i));
    for (std::size_t e = scene_.estimates.size(); e-- > 0;)  // the best on top
      writeMark(picture_.estimates[e], "e" + std::to_string(e), toString(scene_.estimates[e].verdict),
                findText(e) + ", score " + decimal(scene_.estimates[e].estimate.score, 3));
    writeLabels();
    out_ << "</svg></div>\n";
  }

  /// Numbers of the poses that are not right, a little higher than the middle, so that what was missed there has room
  /// below.
  void writeLabels()
  {
    const double size = picture_.width / 42.0;
    for (std::size_t e = 0; e < scene_.estimates.size(); ++e)
      if (!scene_.estimates[e].isHit())
        writeLabel(picture_.estimates[e], size, -0.55, "#" + std::to_string(e + 1));
    for (const std::size_t i : missed_)
      writeLabel(picture_.instances[i], size, 0.55, decimal(100 * scene_.scene.instances[i].visible_fraction, 0) + "%");
  }

  void writeMark(const Outline& outline, const std::string& id, const std::string& kind, const std::string& title)
  {
    if (!outline.path.empty())
      out_ << "<path class=\"mark-" << kind << "\" data-id=\"" << id << "\" d=\"" << outline.path << "\"><title>"
           << escaped(title) << "</title></path>\n";
  }

  /// \param lines by which it is lower than the anchor
  void writeLabel(const Outline& outline, double size, double lines, const std::string& text)
  {
    if (!outline.path.empty())
      out_ << "<text x=\"" << decimal(outline.anchor.x(), 1) << "\" y=\""
           << decimal(outline.anchor.y() + lines * size, 1) << "\" font-size=\"" << decimal(size, 1) << "\">" << text
           << "</text>\n";
  }

  std::string partPrefix(const std::string& part) const { return scene_.scene.parts.size() > 1 ? part + ": " : ""; }

  std::string findText(std::size_t e) const
  {
    return "#" + std::to_string(e + 1) + " " + partPrefix(scene_.estimates[e].estimate.part) + verdictText(scene_, e);
  }

  std::string missedText(std::size_t i) const
  {
    const TrueInstance& instance = scene_.scene.instances[i];
    std::string text = partPrefix(instance.part) + "missed: " + percent(instance.visible_fraction) + " visible";
    if (instance.visible_pixels > 0 && instance.valid_pixels > 0)
      text +=
          ", of that " + percent(static_cast<double>(instance.valid_pixels) / instance.visible_pixels) + " measured";
    return text;
  }

  void writeRow(const std::string& mark, const char* kind, const char* sign, const std::string& text,
                const std::string& score)
  {
    out_ << "<li data-mark=\"" << mark << "\"><span class=\"" << kind << "\">" << sign << "</span><span>"
         << escaped(text) << "</span><span class=\"score\">" << score << "</span></li>\n";
  }

  void writeFind(std::size_t e)
  {
    const JudgedEstimate& judged = scene_.estimates[e];
    writeRow("e" + std::to_string(e), toString(judged.verdict), verdictSign(judged.verdict), findText(e),
             decimal(judged.estimate.score, 3));
  }

  void writeFlaws()
  {
    if (counts_.flawless())
      return;
    out_ << "<ul class=\"finds\">\n";
    for (std::size_t e = 0; e < scene_.estimates.size(); ++e)
      if (!scene_.estimates[e].isHit())
        writeFind(e);
    writeMissed();
    out_ << "</ul>\n";
  }

  void writeMissed()
  {
    if (missed_.empty())
      return;
    out_ << "<li><span class=\"missed\">○</span><span>missed, visible to";
    for (const std::size_t i : missed_)
      out_ << " <span class=\"missed\" data-mark=\"i" << i << "\" title=\"" << escaped(missedText(i)) << "\">"
           << decimal(100 * scene_.scene.instances[i].visible_fraction, 0) << " %</span>";
    out_ << "</span></li>\n";
  }

  void writeHits()
  {
    if (counts_.hits == 0)
      return;
    out_ << "<details><summary>" << counts_.hits << " right</summary><ul class=\"finds\">\n";
    for (std::size_t e = 0; e < scene_.estimates.size(); ++e)
      if (scene_.estimates[e].isHit())
        writeFind(e);
    out_ << "</ul></details>\n";
  }

  const JudgedScene& scene_;
  const ScenePicture& picture_;
  SceneCounts counts_;
  std::vector<std::size_t> missed_;
  std::ostringstream out_;
};
}  // namespace

SceneCounts countsOf(const JudgedScene& scene, double lowest_level)
{
  SceneCounts counts;
  for (const JudgedEstimate& judged : scene.estimates)
  {
    counts.hits += judged.isHit();
    counts.duplicates += judged.verdict == Verdict::Duplicate;
    counts.wrong += judged.verdict == Verdict::Wrong;
  }
  counts.missed = static_cast<int>(missedInstances(scene, lowest_level).size());
  return counts;
}

std::string sceneKinds(const SceneCounts& counts)
{
  if (counts.flawless())
    return "flawless";
  std::string kinds = "flawed";
  kinds += counts.wrong > 0 ? " wrong" : "";
  kinds += counts.duplicates > 0 ? " duplicate" : "";
  kinds += counts.missed > 0 ? " missed" : "";
  return kinds;
}

std::string sceneCard(const JudgedScene& scene, const ScenePicture& picture, double lowest_level)
{
  return Card(scene, picture, lowest_level).html();
}
}  // namespace bin_picking
