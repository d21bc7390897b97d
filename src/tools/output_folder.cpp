// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "output_folder.hpp"

#include <unistd.h>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking::tools
{
namespace fs = std::filesystem;

OutputFolder::OutputFolder(const std::string& name, const std::function<bool(const fs::path&)>& is_ours)
    : target_(fs::absolute(name).lexically_normal())
{
  if (!target_.has_filename())
    target_ = target_.parent_path();  // a slash at the end
  std::error_code error;
  if (fs::exists(target_, error) && !(fs::is_directory(target_) && (fs::is_empty(target_) || is_ours(target_))))
    throw FileError("'" + name +
                    "' exists and holds other things than earlier output of this command; name another folder");
  partial_ = beside("partial");
  for (fs::path above = target_.parent_path(); !fs::exists(above, error) && above.has_filename();
       above = above.parent_path())
    made_.push_back(above);
  fs::create_directories(partial_, error);
  if (error)
    throw FileError("cannot make the folder '" + partial_.string() + "' (" + error.message() +
                    "); check the path and your rights");
}

OutputFolder::~OutputFolder()
{
  std::error_code ignored;
  fs::remove_all(partial_, ignored);
  for (const fs::path& folder : made_)
    fs::remove(folder, ignored);  // only if nothing is in it
}

fs::path OutputFolder::beside(const std::string& purpose) const
{
  fs::path path = target_;
  path += "." + purpose + "-" + std::to_string(getpid());
  return path;
}

void OutputFolder::publish()
{
  const fs::path earlier = beside("earlier");
  std::error_code error;
  std::error_code ignored;
  if (fs::exists(target_, ignored))
    fs::rename(target_, earlier, error);
  if (!error)
  {
    fs::rename(partial_, target_, error);
    if (error)
      fs::rename(earlier, target_, ignored);
  }
  if (error)
    throw FileError("cannot replace the folder '" + target_.string() + "' (" + error.message() + ")");
  fs::remove_all(earlier, ignored);
}
}  // namespace bin_picking::tools
