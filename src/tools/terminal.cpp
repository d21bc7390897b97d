// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "terminal.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/figures.hpp"

namespace bin_picking::tools
{
namespace
{
constexpr const char* WIPE_LINE = "\r\033[K";
}

Progress::Progress() : on_terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() { finish(); }

void Progress::finish()
{
  if (on_terminal_)
    std::cerr << WIPE_LINE << std::flush;
}

void Progress::show(const std::string& stage)
{
  if (on_terminal_)
    std::cerr << WIPE_LINE << "[" << roundedText(watch_.seconds(), 1) << " s] " << stage << " ..." << std::flush;
}

std::string readText(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  if (!file || !(text << file.rdbuf()))
    throw FileError("the file '" + path + "' is missing, empty or cannot be read; check the path");
  return text.str();
}

void writeText(const std::string& path, const std::string& text)
{
  namespace fs = std::filesystem;
  std::error_code error;
  const bool is_pipe = fs::exists(path, error) && !fs::is_regular_file(path, error);  // or a device: not replaceable
  // Renaming replaces an old file at once; what goes wrong before leaves it as it was.
  const std::string written = is_pipe ? path : path + "." + std::to_string(getpid()) + ".tmp";
  std::ofstream file(written, std::ios::binary);
  file << text;
  file.close();
  error.clear();
  if (file && !is_pipe)
    fs::rename(written, path, error);
  if (file && !error)
    return;
  std::error_code ignored;
  if (!is_pipe)
    fs::remove(written, ignored);
  throw FileError("cannot write '" + path + "'; check that the folder exists and has room");
}
}  // namespace bin_picking::tools
