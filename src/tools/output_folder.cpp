// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "output_folder.hpp"

#include <unistd.h>

#include <algorithm>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking::tools
{
namespace fs = std::filesystem;

OutputFolder::OutputFolder(const std::string& name, const std::vector<std::string>& replaceable)
  : target_(fs::absolute(name).lexically_normal())
{
  if (!target_.has_filename())
    target_ = target_.parent_path();  // a slash at the end
  std::error_code ignored;
  const bool ours = std::any_of(replaceable.begin(), replaceable.end(), [&](const std::string& file) {
    return fs::exists(target_ / file, ignored);
  });
  if (fs::exists(target_, ignored) && !ours && !(fs::is_directory(target_) && fs::is_empty(target_)))
    throw FileError("'" + name + "' exists and holds no earlier output of this command; name another folder");
  partial_ = target_;
  partial_ += ".partial-" + std::to_string(getpid());
  std::error_code error;
  fs::create_directories(partial_, error);
  if (error)
    throw FileError("cannot make a folder beside '" + name + "' (" + error.message() + "); check the path and your rights");
}

OutputFolder::~OutputFolder()
{
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
}

void OutputFolder::publish()
{
  std::error_code error;
  fs::remove_all(target_, error);
  if (!error)
    fs::rename(partial_, target_, error);
  if (error)
    throw FileError("cannot replace the folder '" + target_.string() + "' (" + error.message() + ")");
}
}  // namespace bin_picking::tools
