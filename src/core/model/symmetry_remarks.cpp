// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "axis_text.hpp"
#include "bin_picking_perception/common/figures.hpp"
#include "bin_picking_perception/model/symmetry_search.hpp"

namespace bin_picking
{
namespace
{
std::string kindText(int order)
{
  return order == AxisFinding::CONTINUOUS ? "continuous" : "order " + std::to_string(order);
}
}  // namespace

std::vector<std::string> describe(const SymmetryReport& report)
{
  std::vector<std::string> sentences;
  if (report.found.empty())
    sentences.push_back("no turn keeps the surface within " + millimetres(report.tolerance, 2));
  for (const AxisFinding& one : report.found)
    sentences.push_back(kindText(one.order) + " about " + axisText(one.axis) + ": largest deviation " +
                        millimetres(one.mismatch.deviation, 2) + ", up to " + millimetres(report.tolerance, 2) +
                        " is allowed");
  if (report.round)
    sentences.push_back("round about more than one axis: only the position of this part has a meaning");
  for (const AxisFinding& one : report.almost)
    sentences.push_back("almost " + kindText(one.order) + " about " + axisText(one.axis) + ": " +
                        roundedText(100 * one.mismatch.share, 1) + " % of the surface breaks it, up to " +
                        millimetres(one.mismatch.deviation, 2) + " high and " +
                        roundedText(1000 * one.mismatch.region, 0) + " mm across");
  return sentences;
}
}  // namespace bin_picking
