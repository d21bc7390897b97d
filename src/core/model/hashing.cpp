// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <array>
#include <filesystem>
#include <fstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking
{
std::uint64_t hashBytes(const void* data, std::size_t size, std::uint64_t seed)
{
  const auto* bytes = static_cast<const unsigned char*>(data);
  std::uint64_t hash = seed;
  for (std::size_t i = 0; i < size; ++i)
    hash = (hash ^ bytes[i]) * 1099511628211ull;
  return hash;
}

std::uint64_t hashFile(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
    throw FileError("cannot read '" + path + "': there is no such file, or it may not be read; check the path");
  std::uint64_t hash = hashBytes(nullptr, 0);
  std::array<char, 1 << 16> block;
  while (file)
  {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    hash = hashBytes(block.data(), static_cast<std::size_t>(file.gcount()), hash);
  }
  if (file.bad())
    throw FileError("reading '" + path + "' failed; check the disk or the network share that it lies on");
  return hash;
}
}  // namespace bin_picking
