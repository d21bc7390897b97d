// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <yaml-cpp/yaml.h>

#include <Eigen/Core>
#include <string>
#include <vector>

namespace bin_picking
{
/// A map of a YAML file, read strictly: every key is known, every value has its type. What is wrong becomes a FileError
/// that names file and line. Keys that are asked for must be there, unless `has` or a fallback says otherwise.
class YamlMap
{
public:
  /// \throws FileError missing file, not YAML, not a map
  static YamlMap load(const std::string& path);

  /// \throws FileError a key that is not in the list (with "did you mean"), or one that is given twice
  void allowKeys(const std::vector<std::string>& keys) const;

  bool has(const std::string& key) const;
  YamlMap map(const std::string& key) const;
  std::vector<YamlMap> list(const std::string& key) const;  ///< of maps
  std::string text(const std::string& key) const;           ///< not empty
  bool flag(const std::string& key, bool fallback) const;
  int integer(const std::string& key) const;
  int integer(const std::string& key, int fallback) const;
  /// \param unit in SI; the value may carry another that fits, as in parameters.hpp
  double number(const std::string& key, const std::string& unit) const;
  double number(const std::string& key, const std::string& unit, double fallback) const;
  std::vector<double> numbers(const std::string& key, std::size_t count, const std::string& unit) const;
  /// A list of rows, each of so many numbers.
  std::vector<std::vector<double>> rows(const std::string& key, std::size_t columns, const std::string& unit) const;
  Eigen::Vector3d vector(const std::string& key, const std::string& unit) const;
  /// A direction of any length but zero, as a unit vector.
  Eigen::Vector3d direction(const std::string& key) const;
  /// The map under a key as YAML text. Its lines have the numbers that they have in the file.
  std::string yaml(const std::string& key) const;

  /// \throws FileError with the file and the line of the key (of the map, if it has no such key)
  [[noreturn]] void fail(const std::string& key, const std::string& what) const;

private:
  YamlMap(YAML::Node node, std::string path) : node_(std::move(node)), path_(std::move(path)) {}
  YAML::Node child(const std::string& key) const;
  double quantity(const YAML::Node& value, const std::string& key, const std::string& unit) const;

  YAML::Node node_;
  std::string path_;
};
}  // namespace bin_picking
