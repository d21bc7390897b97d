// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "html_calibration.hpp"

#include <sstream>

#include "html_parts.hpp"

namespace bin_picking
{
namespace
{
std::string ratioCell(const Ratio& ratio)
{
  return "<td>" + percent(ratio.value()) + "<small>" + intervalText(ratio) + "</small></td>";
}

std::string track(const CalibrationBin& tenth)
{
  const Interval interval = tenth.right.interval();
  return "<td class=\"reliability\"><div class=\"track\"><i style=\"left:" + decimal(100 * interval.low, 1) +
         "%;right:" + decimal(100 * (1 - interval.high), 1) +
         "%\"></i><b style=\"left:" + decimal(100 * tenth.right.value(), 1) +
         "%\"></b><u style=\"left:" + decimal(100 * tenth.mean_score, 1) + "%\"></u></div></td>";
}
}  // namespace

std::string calibrationSection(const Calibration& tested, const Calibration& returned)
{
  if (tested.count == 0)
    return "";
  std::ostringstream out;
  out << "<h2>Score against truth <span class=\"soft\">" << tested.count << " poses tested in full: Brier score "
      << decimal(tested.brier_score, 3) << ", expected calibration error " << percent(tested.expected_error)
      << "</span></h2>\n<div class=\"panel\"><table>\n<tr><th>score</th><th>tested</th><th>mean "
         "score</th><th>right</th>"
      << "<th class=\"reliability\">right, 95 %; ring: mean score, where a probability would be right</th>"
      << "<th>returned</th><th>right of these</th></tr>\n";
  for (std::size_t k = 0; k < tested.tenths.size(); ++k)
  {
    const CalibrationBin& tenth = tested.tenths[k];
    if (tenth.right.total == 0)
      continue;
    const double low = static_cast<double>(k) / 10;
    const Ratio& accepted = returned.tenths[k].right;
    out << "<tr><td>" << decimal(low, 1) << "–" << decimal(low + 0.1, 1) << "</td><td>" << tenth.right.total
        << "</td><td>" << percent(tenth.mean_score) << "</td>" << ratioCell(tenth.right) << track(tenth) << "<td>"
        << accepted.total << "</td>" << ratioCell(accepted) << "</tr>\n";
  }
  out << "</table></div>\n";
  return out.str();
}
}  // namespace bin_picking
