// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "../common/replace_file.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "binary_stream.hpp"
#include "model_payload.hpp"

namespace bin_picking
{
namespace
{
constexpr std::array<char, 8> MAGIC = {'B', 'P', 'P', 'M', 'O', 'D', 'E', 'L'};
constexpr std::uint32_t BYTE_ORDER_MARK = 0x01020304;
/// Magic, version, byte order, size and hash of the payload.
constexpr std::size_t HEADER_SIZE = 8 + 4 + 4 + 8 + 8;

[[noreturn]] void fail(const std::string& path, const std::string& what)
{
  throw ModelFileError("the model file '" + path + "' " + what + "; train the part again");
}

std::vector<char> readWhole(const std::string& path)
{
  std::error_code ignored;
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file || std::filesystem::is_directory(path, ignored))
    fail(path, "does not exist or may not be read");
  std::vector<char> bytes(static_cast<std::size_t>(file.tellg()));
  file.seekg(0);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(bytes.size())))
    fail(path, "cannot be read to its end");
  return bytes;
}

/// Leaves the reader at the payload. \return its hash as the header states it
std::uint64_t checkHeader(BinaryReader& in, const std::string& path)
{
  std::array<char, 8> magic;
  if (in.left() < magic.size())
    fail(path, "is not a model file: it has only " + std::to_string(in.left()) + " bytes");
  magic = in.value<std::array<char, 8>>();
  if (magic != MAGIC)
    fail(path, "is not a model file: it does not begin with BPPMODEL");
  if (in.left() < HEADER_SIZE - magic.size())
    fail(path, "is truncated within its header");
  const auto version = in.value<std::uint32_t>();
  const auto byte_order = in.value<std::uint32_t>();
  if (byte_order != BYTE_ORDER_MARK)
    fail(path, "was written on a machine of another byte order, or is damaged");
  if (version != MODEL_FILE_VERSION)
    fail(path, "has version " + std::to_string(version) + ", but this program reads version " +
                   std::to_string(MODEL_FILE_VERSION));
  const auto size = in.value<std::uint64_t>();
  const auto hash = in.value<std::uint64_t>();
  if (in.left() < size)
    fail(path, "is truncated: " + std::to_string(in.left()) + " of " + std::to_string(size) + " bytes are there");
  if (in.left() > size)
    fail(path, "is longer than it says: " + std::to_string(in.left()) + " bytes instead of " + std::to_string(size));
  return hash;
}
}  // namespace

void saveModel(const TrainedModel& model, const std::string& path)
{
  const std::vector<char> payload = writePayload(model);
  BinaryWriter header;
  header.value(MAGIC);
  header.value(MODEL_FILE_VERSION);
  header.value(BYTE_ORDER_MARK);
  header.value(static_cast<std::uint64_t>(payload.size()));
  header.value(hashBytes(payload.data(), payload.size()));
  replaceFile(path, [&](std::ostream& file) {
    file.write(header.bytes().data(), static_cast<std::streamsize>(header.bytes().size()));
    file.write(payload.data(), static_cast<std::streamsize>(payload.size()));
  });
}

std::shared_ptr<const TrainedModel> loadModel(const std::string& path)
{
  const std::vector<char> bytes = readWhole(path);
  BinaryReader in(bytes.data(), bytes.size());
  const std::uint64_t hash = checkHeader(in, path);
  const char* payload = bytes.data() + HEADER_SIZE;
  if (hashBytes(payload, in.left()) != hash)
    fail(path, "is damaged: its checksum does not match its content");
  try
  {
    return readPayload(payload, in.left());
  }
  catch (const std::runtime_error& error)
  {
    fail(path, std::string("has content that does not fit together (") + error.what() + ")");
  }
}
}  // namespace bin_picking
