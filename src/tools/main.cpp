// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// bin_picking: the perception of a bin-picking cell from the command line. Exit codes: 0 done (also when nothing was
// found), 1 failed, 2 wrong usage.
#include <algorithm>
#include <exception>
#include <iostream>
#include <string>
#include <vector>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "commands.hpp"

namespace
{
using namespace bin_picking::tools;

constexpr int DONE = 0;
constexpr int FAILED = 1;
constexpr int WRONG_USAGE = 2;

std::vector<Command> commands()
{
  return {trainCommand(),    detectCommand(), matchCommand(),     evaluateCommand(),
          simulateCommand(), graspsCommand(), parametersCommand()};
}

void printOverview(std::ostream& out)
{
  out << "usage: bin_picking COMMAND ...\n\nFinds the 6D poses of parts in a bin.\n\ncommands:\n";
  for (const Command& command : commands())
    out << "  " << command.syntax.command << std::string(12 - command.syntax.command.size(), ' ')
        << command.syntax.summary << "\n";
  out << "\n'bin_picking COMMAND --help' explains one; 'bin_picking --version' tells the version.\n";
}

Command findCommand(const std::string& name)
{
  std::vector<std::string> known;
  for (const Command& command : commands())
  {
    if (command.syntax.command == name)
      return command;
    known.push_back(command.syntax.command);
  }
  const std::string guess = bin_picking::didYouMean(name, known);
  throw UsageError("unknown command '" + name + "'" +
                   (guess.empty() ? "; 'bin_picking --help' lists the commands" : "; did you mean '" + guess + "'?"));
}

int run(const std::vector<std::string>& words)
{
  if (words.empty())
  {
    printOverview(std::cerr);
    return WRONG_USAGE;
  }
  if (words[0] == "--help" || words[0] == "-h" || words[0] == "help")
  {
    printOverview(std::cout);
    return DONE;
  }
  if (words[0] == "--version")
  {
    std::cout << "bin_picking " << BIN_PICKING_VERSION << "\n";
    return DONE;
  }
  const Command command = findCommand(words[0]);
  const std::vector<std::string> rest(words.begin() + 1, words.end());
  const bool wants_help =
      std::any_of(rest.begin(), rest.end(), [](const std::string& word) { return word == "--help" || word == "-h"; });
  if (wants_help)
    std::cout << helpText(command.syntax);
  else
    command.run(Arguments(command.syntax, rest));
  return DONE;
}
}  // namespace

int main(int argc, char** argv)
{
  try
  {
    return run({argv + 1, argv + argc});
  }
  catch (const UsageError& error)
  {
    std::cerr << "bin_picking: " << error.what() << "\n";
    return WRONG_USAGE;
  }
  catch (const bin_picking::ParameterError& error)
  {
    std::cerr << "bin_picking: " << error.what() << "\n";
    return WRONG_USAGE;
  }
  catch (const std::exception& error)
  {
    std::cerr << "bin_picking: " << error.what() << "\n";
    return FAILED;
  }
}
