// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bin_picking::tools
{
/// A folder that appears under its name only when it is complete: until then it is filled under another name beside it,
/// and wiped if it is never published.
class OutputFolder
{
public:
  /// \param replaceable an existing folder may be replaced if it is empty or holds one of these
  /// \throws FileError the name is taken by something else, or the folder cannot be made
  OutputFolder(const std::string& name, const std::vector<std::string>& replaceable);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write.
  const std::filesystem::path& path() const { return partial_; }
  /// Gives it its name. \throws FileError
  void publish();

private:
  std::filesystem::path target_;
  std::filesystem::path partial_;
};
}  // namespace bin_picking::tools
