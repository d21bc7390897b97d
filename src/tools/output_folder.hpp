// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace bin_picking::tools
{
/// A folder that appears under its name only when it is complete: until then it is filled under another name beside it,
/// and wiped if it is never published.
class OutputFolder
{
public:
  /// \param is_ours whether a folder holds earlier output and nothing else, so that it may be replaced; empty ones may
  /// \throws FileError the name is taken by something else, or the folder cannot be made
  OutputFolder(const std::string& name, const std::function<bool(const std::filesystem::path&)>& is_ours);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write.
  const std::filesystem::path& path() const { return partial_; }
  /// Gives it its name. \throws FileError
  void publish();

private:
  std::filesystem::path beside(const std::string& purpose) const;

  std::filesystem::path target_;
  std::filesystem::path partial_;
  std::vector<std::filesystem::path> made_;  ///< folders above it that were missing, the innermost first
};
}  // namespace bin_picking::tools
