// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace bin_picking
{
using Json = nlohmann::json;

/// \throws FileError missing, not JSON
Json loadJson(const std::string& path);

/// \throws FileError with the file, what nlohmann found wrong in its content, and what is expected there
[[noreturn]] void failContent(const std::string& path, const nlohmann::json::exception& error,
                              const std::string& expected);
}  // namespace bin_picking
