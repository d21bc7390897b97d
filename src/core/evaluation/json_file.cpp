// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "json_file.hpp"

#include <fstream>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
/// Without the "[json.exception...]" in front, which tells a user nothing.
std::string reasonOf(const nlohmann::json::exception& error)
{
  const std::string text = error.what();
  const auto end = text.find("] ");
  return end == std::string::npos ? text : text.substr(end + 2);
}
}  // namespace

Json loadJson(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  // A folder can be opened too; only reading tells.
  if (!file || file.peek() == std::ifstream::traits_type::eof())
    throw FileError("The file " + path + " is missing, empty or cannot be read; check that the data set is complete.");
  try
  {
    return Json::parse(file);
  }
  catch (const nlohmann::json::exception& error)
  {
    throw FileError("The file " + path + " is not valid JSON (" + reasonOf(error) + "); get it again.");
  }
}

void failContent(const std::string& path, const nlohmann::json::exception& error, const std::string& expected)
{
  throw FileError("The file " + path + " lacks something or has it in another form (" + reasonOf(error) +
                  "); expected is " + expected + ".");
}
}  // namespace bin_picking
