// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>
#include <vector>

#include "core/temporary_folder.hpp"

namespace bin_picking
{
namespace test
{
struct Outcome
{
  int exit_code = -1;
  std::string text;  ///< both streams
};

/// Runs bin_picking through a shell. \param before shell commands to go before it, such as "cd folder && "
inline Outcome runCommand(const std::string& arguments, const std::string& before = "")
{
  Outcome result;
  FILE* pipe = popen((before + BIN_PICKING_EXECUTABLE + " " + arguments + " 2>&1").c_str(), "r");
  if (!pipe)
    return result;
  std::array<char, 4096> buffer;
  for (std::size_t read = 0; (read = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    result.text.append(buffer.data(), read);
  const int status = pclose(pipe);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

/// Expects that it ends with this exit code and that its message holds all the words.
inline void expectCommandFails(const std::string& arguments, int exit_code, const std::vector<std::string>& said)
{
  const Outcome result = runCommand(arguments);
  EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.text;
  SCOPED_TRACE(arguments);
  expectWords(result.text, said);
}
}  // namespace test
}  // namespace bin_picking
