// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace bin_picking
{
/// What is said once about a parameter, at its field.
struct ParameterInfo
{
  const char* name;    ///< key, under_scored
  const char* unit;    ///< "m", "rad", "1/m", "" ...
  const char* effect;  ///< one sentence: what grows or shrinks with it
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// Walks over the fields of a parameter struct. A struct takes part by a member
///   void visit(ParameterVisitor& v);
/// that calls v.field(...) for each field and v.group(name, nested) for nested structs. YAML, command line, rosparam
/// and the documentation are all made from this one list.
class ParameterVisitor
{
public:
  virtual ~ParameterVisitor() = default;

  virtual void field(const ParameterInfo& info, double& value) = 0;
  virtual void field(const ParameterInfo& info, int& value) = 0;
  virtual void field(const ParameterInfo& info, bool& value) = 0;
  /// \param choices the allowed values; empty: any text.
  virtual void field(const ParameterInfo& info, std::string& value, const std::vector<std::string>& choices) = 0;

  /// An enumeration, written by name.
  template <typename Enum>
  void field(const ParameterInfo& info, Enum& value, const std::vector<std::pair<std::string, Enum>>& names)
  {
    std::string text;
    std::vector<std::string> choices;
    for (const auto& [name, candidate] : names)
    {
      choices.push_back(name);
      if (candidate == value)
        text = name;
    }
    field(info, text, choices);
    for (const auto& [name, candidate] : names)
      if (name == text)
        value = candidate;
  }

  template <typename Group>
  void group(const std::string& name, Group& nested)
  {
    enter(name);
    nested.visit(*this);
    leave();
  }

protected:
  virtual void enter(const std::string& group) = 0;
  virtual void leave() = 0;
};

/// One parameter as text, for documentation and dumps.
struct ParameterEntry
{
  std::string path;  ///< "matching/d_dist"
  std::string value;
  std::string unit;
  std::string range;  ///< "[0, 1]", "one of: a, b" or ""
  std::string effect;
  bool is_text = false;  ///< a string or an enumeration
};

using VisitFunction = std::function<void(ParameterVisitor&)>;

/// Sets one parameter from text. A number may carry a unit that fits the field's: mm, cm, m; deg, rad; /mm, /m; ms, s;
/// %. \param path "matching/d_dist" (a dot in place of the slash is accepted) \throws ParameterError unknown path (with
/// the nearest known one), not a number, out of range
void setParameter(const VisitFunction& visit, const std::string& path, const std::string& text);

/// Reads "path=value", as given to --set.
void setParameter(const VisitFunction& visit, const std::string& assignment);

/// Sets every parameter that the YAML text names (nested maps). `origin` names the source in messages.
/// \throws ParameterError as setParameter, with the line
void setParametersFromYaml(const VisitFunction& visit, const std::string& yaml, const std::string& origin);

std::vector<ParameterEntry> listParameters(const VisitFunction& visit);

/// YAML with a comment per parameter: unit, range, effect.
std::string toYaml(const VisitFunction& visit);

/// A Markdown table of all parameters.
std::string toMarkdown(const VisitFunction& visit);

/// The known word closest to a mistyped one; empty when none is near.
std::string didYouMean(const std::string& word, const std::vector<std::string>& known);

/// The visit function of any parameter struct; the struct must outlive it.
template <typename Parameters>
VisitFunction visitor(Parameters& parameters)
{
  return [&parameters](ParameterVisitor& v) { parameters.visit(v); };
}

/// Whether all values are what setParameter would take: in less than a microsecond, where that takes a hundred.
bool areWithinRanges(const VisitFunction& visit);

/// Throws what setParameter would throw for a value that is out of its range.
template <typename Parameters>
void checkRanges(Parameters parameters)
{
  if (areWithinRanges(visitor(parameters)))
    return;
  for (const ParameterEntry& entry : listParameters(visitor(parameters)))
    setParameter(visitor(parameters), entry.path, entry.value);
}

/// A number with an optional unit suffix, in SI: "3mm" -> 0.003, "12deg" -> 0.2094, "0.03/mm" -> 30.
/// \param unit SI unit that the text must fit ("m", "rad", "1/m", "s", "")
double parseQuantity(const std::string& text, const std::string& unit);
}  // namespace bin_picking
