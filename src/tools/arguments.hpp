// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace bin_picking::tools
{
/// The command line cannot be understood; what() says why and what would do. Exit code 2.
class UsageError : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

enum class Values
{
  None,  ///< a switch
  One,
  Many,        ///< one or more, up to the next option; may be repeated
  Assignments  ///< one or more key=value; may be repeated
};

struct Option
{
  std::string name;         ///< "--leaf" or "-o"
  std::string placeholder;  ///< "LENGTH", for the help; empty for a switch
  Values values = Values::One;
  std::string help;
  bool required = false;
};

/// What a sub-command understands, and the source of its help text.
struct Syntax
{
  std::string command;
  std::string summary;                   ///< one sentence
  std::vector<std::string> positionals;  ///< placeholders, all required; "NAME..." as the last one: one or more
  std::vector<Option> options;           ///< --help is always there
  std::string example;                   ///< a command line that works, without the program's name
  std::string program = "bin_picking";   ///< without a command, what stands alone
};

/// The command line of a sub-command, checked against its syntax.
class Arguments
{
public:
  /// \throws UsageError unknown option (with "did you mean"), missing value, missing or superfluous argument
  Arguments(const Syntax& syntax, const std::vector<std::string>& words);

  bool has(const std::string& option) const { return values_.count(option) > 0; }
  /// The value of an option, or the fallback if it was not given.
  std::string value(const std::string& option, const std::string& fallback = "") const;
  const std::vector<std::string>& values(const std::string& option) const;
  const std::string& positional(std::size_t index) const { return positionals_.at(index); }
  const std::vector<std::string>& positionals() const { return positionals_; }

private:
  void readOption(const Syntax& syntax, const std::vector<std::string>& words, std::size_t& next);

  std::map<std::string, std::vector<std::string>> values_;
  std::vector<std::string> positionals_;
};

std::string helpText(const Syntax& syntax);

/// \throws UsageError not a whole number in [low, high]
int parseInteger(const std::string& text, const std::string& option, int low, int high);
}  // namespace bin_picking::tools
