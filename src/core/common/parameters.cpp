// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/common/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "parameter_text.hpp"

namespace bin_picking
{
namespace
{
std::string join(const std::vector<std::string>& words, const std::string& separator)
{
  std::string text;
  for (const auto& word : words)
    text += (text.empty() ? "" : separator) + word;
  return text;
}

/// Keeps track of the path of the group that is visited.
class PathVisitor : public ParameterVisitor
{
protected:
  void enter(const std::string& group) override { groups_.push_back(group); }
  void leave() override { groups_.pop_back(); }
  std::string path(const ParameterInfo& info) const
  {
    return groups_.empty() ? info.name : join(groups_, "/") + "/" + info.name;
  }

private:
  std::vector<std::string> groups_;
};

class Lister : public PathVisitor
{
public:
  using PathVisitor::field;
  void field(const ParameterInfo& info, double& value) override
  {
    add(info, formatNumber(value), rangeText(info, "-inf", "inf"), false);
  }
  void field(const ParameterInfo& info, int& value) override
  {
    add(info, std::to_string(value), rangeText(info, "-inf", "inf"), false);
  }
  void field(const ParameterInfo& info, bool& value) override
  {
    add(info, value ? "true" : "false", "one of: true, false", false);
  }
  void field(const ParameterInfo& info, std::string& value, const std::vector<std::string>& choices) override
  {
    add(info, value, choices.empty() ? "" : "one of: " + join(choices, ", "), true);
  }

  std::vector<ParameterEntry> entries;

private:
  void add(const ParameterInfo& info, const std::string& value, const std::string& range, bool is_text)
  {
    entries.push_back({path(info), value, info.unit, range, info.effect, is_text});
  }
};

/// Sets the one field whose path was asked for.
class Setter : public PathVisitor
{
public:
  Setter(std::string path, std::string text) : wanted_(std::move(path)), text_(std::move(text)) {}

  using PathVisitor::field;
  void field(const ParameterInfo& info, double& value) override
  {
    if (!matches(info))
      return;
    const double number = quantity(info);
    checkRange(info, number);
    value = number;
  }
  void field(const ParameterInfo& info, int& value) override
  {
    if (!matches(info))
      return;
    const double number = quantity(info);
    if (number != std::floor(number) || std::abs(number) > 2e9)
      throw ParameterError("parameter '" + wanted_ + "' is '" + text_ + "', but it must be a whole number");
    checkRange(info, number);
    value = static_cast<int>(number);
  }
  void field(const ParameterInfo& info, bool& value) override
  {
    if (!matches(info))
      return;
    if (text_ == "true" || text_ == "1" || text_ == "on" || text_ == "yes")
      value = true;
    else if (text_ == "false" || text_ == "0" || text_ == "off" || text_ == "no")
      value = false;
    else
      throw ParameterError("parameter '" + wanted_ + "' is '" + text_ + "', but it must be true or false");
  }
  void field(const ParameterInfo& info, std::string& value, const std::vector<std::string>& choices) override
  {
    if (!matches(info))
      return;
    if (!choices.empty() && std::find(choices.begin(), choices.end(), text_) == choices.end())
    {
      const std::string guess = didYouMean(text_, choices);
      throw ParameterError("parameter '" + wanted_ + "' is '" + text_ + "', but it must be one of: " +
                           join(choices, ", ") + (guess.empty() ? "" : " (did you mean '" + guess + "'?)"));
    }
    value = text_;
  }

  bool found() const { return found_; }

private:
  bool matches(const ParameterInfo& info)
  {
    const bool match = path(info) == wanted_;
    found_ = found_ || match;
    return match;
  }
  double quantity(const ParameterInfo& info) const
  {
    try
    {
      return parseQuantity(text_, info.unit);
    }
    catch (const ParameterError& error)
    {
      throw ParameterError("parameter '" + wanted_ + "': " + error.what());
    }
  }
  void checkRange(const ParameterInfo& info, double number) const
  {
    if (std::isnan(number) || number < info.min || number > info.max)
      throw ParameterError("parameter '" + wanted_ + "' is " + formatNumber(number) + ", but it must lie in " +
                           rangeText(info, "-inf", "inf") + (*info.unit ? std::string(" ") + info.unit : "") + ": " +
                           info.effect);
  }

  std::string wanted_;
  std::string text_;
  bool found_ = false;
};

/// Whether each value is one that could be set; without a text of any.
class RangeProbe : public ParameterVisitor
{
public:
  using ParameterVisitor::field;
  void field(const ParameterInfo& info, double& value) override { look(info, value); }
  void field(const ParameterInfo& info, int& value) override { look(info, value); }
  void field(const ParameterInfo&, bool&) override {}
  void field(const ParameterInfo&, std::string& value, const std::vector<std::string>& choices) override
  {
    all_within = all_within && (choices.empty() || std::find(choices.begin(), choices.end(), value) != choices.end());
  }

  bool all_within = true;

private:
  void look(const ParameterInfo& info, double value)
  {
    all_within = all_within && std::isfinite(value) && value >= info.min && value <= info.max;
  }
  void enter(const std::string&) override {}
  void leave() override {}
};
}  // namespace

bool areWithinRanges(const VisitFunction& visit)
{
  RangeProbe probe;
  visit(probe);
  return probe.all_within;
}

void setParameter(const VisitFunction& visit, const std::string& path, const std::string& text)
{
  std::string slashed = path;
  std::replace(slashed.begin(), slashed.end(), '.', '/');
  Setter setter(slashed, text);
  visit(setter);
  if (setter.found())
    return;
  std::vector<std::string> known;
  for (const auto& entry : listParameters(visit))
    known.push_back(entry.path);
  const std::string guess = didYouMean(slashed, known);
  throw ParameterError(
      "unknown parameter '" + slashed + "'" +
      (guess.empty() ? "; run 'bin_picking parameters' for the list" : "; did you mean '" + guess + "'?"));
}

void setParameter(const VisitFunction& visit, const std::string& assignment)
{
  const auto equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw ParameterError("'" + assignment + "' is not of the form parameter=value, for example voting/weight=3");
  setParameter(visit, assignment.substr(0, equals), assignment.substr(equals + 1));
}

std::vector<ParameterEntry> listParameters(const VisitFunction& visit)
{
  Lister lister;
  visit(lister);
  return lister.entries;
}

std::string toMarkdown(const VisitFunction& visit)
{
  std::ostringstream out;
  out << "| parameter | default | unit | range | effect |\n|---|---|---|---|---|\n";
  for (const auto& entry : listParameters(visit))
    out << "| `" << entry.path << "` | " << entry.value << " | " << entry.unit << " | " << entry.range << " | "
        << entry.effect << " |\n";
  return out.str();
}

std::string toYaml(const VisitFunction& visit)
{
  std::ostringstream out;
  std::string group;
  for (const auto& entry : listParameters(visit))
  {
    const auto slash = entry.path.rfind('/');
    const std::string entry_group = slash == std::string::npos ? "" : entry.path.substr(0, slash);
    if (entry_group != group && !entry_group.empty())
      out << entry_group << ":\n";
    group = entry_group;
    out << (group.empty() ? "" : "  ") << entry.path.substr(slash == std::string::npos ? 0 : slash + 1) << ": "
        << (entry.is_text ? "\"" + entry.value + "\"" : entry.value) << "  # "
        << (entry.unit.empty() ? "" : entry.unit + "; ") << (entry.range.empty() ? "" : entry.range + "; ")
        << entry.effect << "\n";
  }
  return out.str();
}
}  // namespace bin_picking
