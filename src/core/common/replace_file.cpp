// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "replace_file.hpp"

#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
/// Removes the temporary file, unless it was renamed by then.
class TemporaryFile
{
public:
  explicit TemporaryFile(std::string path) : path_(std::move(path)) {}
  ~TemporaryFile()
  {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }

private:
  std::string path_;
};
}  // namespace

void replaceFile(const std::string& path, const std::function<void(std::ostream&)>& write)
{
  const TemporaryFile temporary(path + "." + std::to_string(getpid()) + ".tmp");
  std::ofstream file(temporary.path(), std::ios::binary | std::ios::trunc);
  if (file)
    write(file);
  file.close();
  if (!file)
    throw FileError("cannot write '" + path + "'; check that the folder exists, may be written and has space left");
  std::error_code error;
  std::filesystem::rename(temporary.path(), path, error);
  if (error)
    throw FileError("cannot write '" + path + "' (" + error.message() + "); check the path");
}
}  // namespace bin_picking
