// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <functional>
#include <ostream>
#include <string>

namespace bin_picking
{
/// Writes a file under a temporary name beside its place and renames it: whoever reads meanwhile sees the old file or
/// the new one, never a part; if anything fails, the old one stays. \throws FileError it cannot be written
void replaceFile(const std::string& path, const std::function<void(std::ostream&)>& write);
}  // namespace bin_picking
