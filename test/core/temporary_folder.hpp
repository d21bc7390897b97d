// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace bin_picking
{
namespace test
{
/// A fresh folder that goes away with the object.
class TemporaryFolder
{
public:
  TemporaryFolder()
  {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    const auto* suite = testing::UnitTest::GetInstance()->current_test_suite();  // while it is set up there is no test
    path_ = std::filesystem::temp_directory_path() /
            (std::string("bin_picking_") + (test ? test->name() : suite->name()) + "_" + std::to_string(getpid()));
    std::filesystem::remove_all(path_);
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder()
  {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string path(const std::string& name) const { return (path_ / name).string(); }

  /// Writes a file into the folder. \return its path
  std::string write(const std::string& name, const std::string& content) const
  {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }

private:
  std::filesystem::path path_;
};

inline std::string readFile(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

/// The message of the error that `action` throws; a failure of the test if it throws none or another.
template <typename ExpectedError, typename Action>
std::string messageOf(const Action& action)
{
  try
  {
    action();
  }
  catch (const ExpectedError& error)
  {
    return error.what();
  }
  catch (const std::exception& error)
  {
    ADD_FAILURE() << "another error: " << error.what();
    return {};
  }
  ADD_FAILURE() << "no error";
  return {};
}

/// Expects that all words occur in the text.
inline void expectWords(const std::string& text, const std::vector<std::string>& words)
{
  for (const auto& word : words)
    EXPECT_NE(text.find(word), std::string::npos) << "'" << word << "' is not in: " << text;
}
}  // namespace test
}  // namespace bin_picking
