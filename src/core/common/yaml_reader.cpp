// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "yaml_reader.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parameters.hpp"

namespace bin_picking
{
namespace
{
[[noreturn]] void failAt(const std::string& path, const YAML::Mark& mark, const std::string& what)
{
  throw FileError(path + (mark.is_null() ? "" : ":" + std::to_string(mark.line + 1)) + ": " + what);
}

std::string join(const std::vector<std::string>& words)
{
  std::string text;
  for (const auto& word : words)
    text += (text.empty() ? "" : ", ") + word;
  return text;
}
}  // namespace

YamlMap YamlMap::load(const std::string& path)
{
  std::ifstream file(path);
  std::error_code ignored;
  if (!file || std::filesystem::is_directory(path, ignored))
    throw FileError("cannot open '" + path + "': there is no such file, or it may not be read; check the path");
  YAML::Node root;
  try
  {
    root = YAML::Load(file);
  }
  catch (const YAML::Exception& error)
  {
    failAt(path, error.mark, "not valid YAML (" + error.msg + "); check indentation, brackets and quotes");
  }
  if (!root.IsMap())
    failAt(path, root.Mark(), "the file must be a map of keys and values, 'key: value'");
  return YamlMap(root, path);
}

void YamlMap::allowKeys(const std::vector<std::string>& keys) const
{
  std::set<std::string> seen;
  for (const auto& entry : node_)
  {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    if (std::find(keys.begin(), keys.end(), key) == keys.end())
    {
      const std::string guess = didYouMean(key, keys);
      failAt(path_, entry.first.Mark(),
             "unknown key '" + key + "'" + (guess.empty() ? "" : "; did you mean '" + guess + "'?") +
                 (guess.empty() ? "; known here are: " : " Known here are: ") + join(keys));
    }
    if (!seen.insert(key).second)
      failAt(path_, entry.first.Mark(), "the key '" + key + "' is given twice; keep one of them");
  }
}

bool YamlMap::has(const std::string& key) const { return node_[key].IsDefined(); }

YAML::Node YamlMap::child(const std::string& key) const
{
  const YAML::Node value = node_[key];
  if (!value.IsDefined())
    failAt(path_, node_.Mark(), "the key '" + key + "' is missing; add it");
  return value;
}

YamlMap YamlMap::map(const std::string& key) const
{
  const YAML::Node value = child(key);
  if (!value.IsMap())
    fail(key, "'" + key + "' must be a map of keys and values");
  return YamlMap(value, path_);
}

std::vector<YamlMap> YamlMap::list(const std::string& key) const
{
  const YAML::Node value = child(key);
  if (!value.IsSequence())
    fail(key, "'" + key + "' must be a list: each entry begins with '-'");
  std::vector<YamlMap> entries;
  for (const auto& entry : value)
  {
    if (!entry.IsMap())
      failAt(path_, entry.Mark(), "each entry of '" + key + "' must be a map of keys and values");
    entries.push_back(YamlMap(entry, path_));
  }
  return entries;
}

std::string YamlMap::text(const std::string& key) const
{
  const YAML::Node value = child(key);
  if (!value.IsScalar() || value.Scalar().empty())
    fail(key, "'" + key + "' must be a text, and not empty");
  return value.Scalar();
}

bool YamlMap::flag(const std::string& key, bool fallback) const
{
  if (!has(key))
    return fallback;
  const std::string word = text(key);
  if (word != "true" && word != "false")
    fail(key, "'" + key + "' is '" + word + "', but it must be true or false");
  return word == "true";
}

int YamlMap::integer(const std::string& key) const
{
  const double value = number(key, "");
  if (value != std::floor(value) || std::abs(value) > 1e9)
    fail(key, "'" + key + "' is '" + text(key) + "', but it must be a whole number");
  return static_cast<int>(value);
}

int YamlMap::integer(const std::string& key, int fallback) const { return has(key) ? integer(key) : fallback; }

double YamlMap::quantity(const YAML::Node& value, const std::string& key, const std::string& unit) const
{
  if (!value.IsScalar())
    failAt(path_, value.Mark(), "'" + key + "' must be made of single numbers");
  try
  {
    const double number = parseQuantity(value.Scalar(), unit);
    if (std::isfinite(number))
      return number;
  }
  catch (const ParameterError& error)
  {
    failAt(path_, value.Mark(),
           "'" + key + "': " + error.what() + (unit.empty() ? "" : " (without a unit: " + unit + ")"));
  }
  failAt(path_, value.Mark(), "'" + key + "' is '" + value.Scalar() + "', but it must be finite");
}

double YamlMap::number(const std::string& key, const std::string& unit) const
{
  return quantity(child(key), key, unit);
}

double YamlMap::number(const std::string& key, const std::string& unit, double fallback) const
{
  return has(key) ? number(key, unit) : fallback;
}

std::vector<double> YamlMap::numbers(const std::string& key, std::size_t count, const std::string& unit) const
{
  const YAML::Node value = child(key);
  if (!value.IsSequence() || value.size() != count)
    fail(key, "'" + key + "' must be a list of " + std::to_string(count) + " numbers" +
                  (value.IsSequence() ? ", but it has " + std::to_string(value.size()) : ""));
  std::vector<double> result;
  for (const auto& entry : value)
    result.push_back(quantity(entry, key, unit));
  return result;
}

std::vector<std::vector<double>> YamlMap::rows(const std::string& key, std::size_t columns,
                                               const std::string& unit) const
{
  const YAML::Node value = child(key);
  const std::string wanted = "'" + key + "' must be a list of rows of " + std::to_string(columns) + " numbers each";
  if (!value.IsSequence())
    fail(key, wanted);
  std::vector<std::vector<double>> result;
  for (const auto& row : value)
  {
    if (!row.IsSequence() || row.size() != columns)
      failAt(path_, row.Mark(), wanted);
    result.emplace_back();
    for (const auto& entry : row)
      result.back().push_back(quantity(entry, key, unit));
  }
  return result;
}

Eigen::Vector3d YamlMap::vector(const std::string& key, const std::string& unit) const
{
  const std::vector<double> values = numbers(key, 3, unit);
  return {values[0], values[1], values[2]};
}

Eigen::Vector3d YamlMap::direction(const std::string& key) const
{
  const Eigen::Vector3d value = vector(key, "");
  if (!(value.norm() > 1e-9))
    fail(key, "'" + key + "' is a direction and must not be [0, 0, 0]");
  return value.normalized();
}

std::string YamlMap::yaml(const std::string& key) const
{
  const YAML::Node value = child(key);
  if (!value.IsMap())
    fail(key, "'" + key + "' must be a map of keys and values");
  std::string text;
  int line = 0;
  for (const auto& entry : value)
  {
    // Entries that share a line, in braces, come one below the other: only the first keeps its line then.
    if (!text.empty() && text.back() != '\n')
    {
      text += '\n';
      ++line;
    }
    for (; line < entry.first.Mark().line; ++line)
      text += '\n';
    YAML::Emitter out;
    out << YAML::Flow << entry.second;
    text += entry.first.Scalar() + ": " + out.c_str();
  }
  return text;
}

void YamlMap::fail(const std::string& key, const std::string& what) const
{
  for (const auto& entry : node_)
    if (entry.first.IsScalar() && entry.first.Scalar() == key)
      failAt(path_, entry.first.Mark(), what);
  failAt(path_, node_.Mark(), what);
}
}  // namespace bin_picking
