// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "arguments.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "bin_picking_perception/common/parameters.hpp"

namespace bin_picking::tools
{
namespace
{
/// What is called: "bin_picking train", or a program that stands alone.
std::string callOf(const Syntax& syntax)
{
  return syntax.command.empty() ? syntax.program : syntax.program + " " + syntax.command;
}

std::string exampleOf(const Syntax& syntax) { return syntax.program + " " + syntax.example; }

constexpr std::size_t HELP_COLUMN = 26;

bool isOption(const std::string& word) { return word.size() > 1 && word[0] == '-'; }

const Option& findOption(const Syntax& syntax, const std::string& name)
{
  std::vector<std::string> known;
  for (const Option& option : syntax.options)
  {
    if (option.name == name)
      return option;
    known.push_back(option.name);
  }
  const std::string guess = didYouMean(name, known);
  throw UsageError(
      "unknown option '" + name + "'" +
      (guess.empty() ? "; '" + callOf(syntax) + " --help' lists the options" : "; did you mean '" + guess + "'?"));
}

bool belongsTo(const Option& option, const std::string& word)
{
  return !isOption(word) && (option.values == Values::Many || word.find('=') != std::string::npos);
}

std::string usageOf(const Option& option)
{
  if (option.values == Values::None)
    return option.name;
  return option.name + " " + option.placeholder + (option.values == Values::One ? "" : "...");
}

bool takesMore(const Syntax& syntax)
{
  const std::string ending = "...";
  if (syntax.positionals.empty() || syntax.positionals.back().size() < ending.size())
    return false;
  const std::string& last = syntax.positionals.back();
  return last.compare(last.size() - ending.size(), ending.size(), ending) == 0;
}

std::string quoted(const std::string& word) { return "'" + word + "'"; }
}  // namespace

Arguments::Arguments(const Syntax& syntax, const std::vector<std::string>& words)
{
  for (std::size_t next = 0; next < words.size();)
  {
    if (isOption(words[next]))
      readOption(syntax, words, next);
    else
      positionals_.push_back(words[next++]);
  }
  if (positionals_.size() > syntax.positionals.size() && !takesMore(syntax))
    throw UsageError("superfluous argument " + quoted(positionals_[syntax.positionals.size()]) + "; '" +
                     callOf(syntax) + " --help' shows what is understood");
  if (positionals_.size() < syntax.positionals.size())
    throw UsageError(syntax.positionals[positionals_.size()] + " is missing; for example: " + exampleOf(syntax));
  for (const Option& option : syntax.options)
    if (option.required && !has(option.name))
      throw UsageError("option " + quoted(usageOf(option)) + " is missing; for example: " + exampleOf(syntax));
}

void Arguments::readOption(const Syntax& syntax, const std::vector<std::string>& words, std::size_t& next)
{
  std::string name = words[next++];
  std::vector<std::string> values;
  const auto equals = name.find('=');
  if (equals != std::string::npos)
  {
    values.push_back(name.substr(equals + 1));
    name.resize(equals);
  }
  const Option& option = findOption(syntax, name);
  if (option.values == Values::None && !values.empty())
    throw UsageError("option " + quoted(name) + " takes no value, but " + quoted(values[0]) + " was given");
  if (option.values != Values::None && values.empty())
  {
    if (next == words.size() || words[next].rfind("--", 0) == 0)
      throw UsageError("option " + quoted(name) + " needs a value: " + usageOf(option));
    values.push_back(words[next++]);
  }
  if (option.values == Values::Many || option.values == Values::Assignments)
    while (next < words.size() && belongsTo(option, words[next]))
      values.push_back(words[next++]);
  else if (has(name))
    throw UsageError("option " + quoted(name) + " was given twice; keep one of them");
  auto& all = values_[name];
  all.insert(all.end(), values.begin(), values.end());
}

std::string Arguments::value(const std::string& option, const std::string& fallback) const
{
  const auto found = values_.find(option);
  return found == values_.end() ? fallback : found->second.at(0);
}

const std::vector<std::string>& Arguments::values(const std::string& option) const
{
  static const std::vector<std::string> NONE;
  const auto found = values_.find(option);
  return found == values_.end() ? NONE : found->second;
}

std::string helpText(const Syntax& syntax)
{
  std::ostringstream out;
  out << "usage: " << callOf(syntax);
  for (const std::string& positional : syntax.positionals)
    out << " " << positional;
  for (const Option& option : syntax.options)
    out << " " << (option.required ? usageOf(option) : "[" + usageOf(option) + "]");
  out << "\n\n" << syntax.summary << "\n\noptions:\n";
  for (const Option& option : syntax.options)
  {
    const std::string usage = usageOf(option);
    out << "  " << usage << std::string(usage.size() < HELP_COLUMN ? HELP_COLUMN - usage.size() : 1, ' ') << option.help
        << "\n";
  }
  out << "\nexample: " << exampleOf(syntax) << "\n";
  return out.str();
}

int parseInteger(const std::string& text, const std::string& option, int low, int high)
{
  char* end = nullptr;
  const long number = std::strtol(text.c_str(), &end, 10);
  if (text.empty() || *end != '\0' || number < low || number > high)
    throw UsageError("option '" + option + "' is " + quoted(text) + ", but it must be a whole number in [" +
                     std::to_string(low) + ", " + std::to_string(high) + "]");
  return static_cast<int>(number);
}
}  // namespace bin_picking::tools
