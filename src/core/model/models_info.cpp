// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/model/models_info.hpp"

#include <fstream>

#include "../common/replace_file.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "models_info_entry.hpp"
#include "part_size.hpp"

namespace bin_picking
{
namespace
{
using Json = nlohmann::json;

Json parse(const std::string& path)
{
  requireReadableFile(path);
  std::ifstream file(path);
  try
  {
    return Json::parse(file);
  }
  catch (const Json::exception& error)
  {
    throw FileError("'" + path + "' is not JSON (" + error.what() + "); check that it is a complete models_info.json");
  }
}

[[noreturn]] void fail(const std::string& path, const std::string& model, const std::string& what)
{
  throw FileError("'" + path + "', model " + model + ": " + what);
}

/// -1: not an id, so that the caller can name the file.
int parseId(const std::string& text)
{
  constexpr std::size_t MAX_DIGITS = 9;
  if (text.empty() || text.size() > MAX_DIGITS || text.find_first_not_of("0123456789") != std::string::npos)
    return -1;
  return std::stoi(text);
}
}  // namespace

std::map<int, ModelInfo> loadModelsInfo(const std::string& path)
{
  const Json json = parse(path);
  if (!json.is_object() || json.empty())
    throw FileError("'" + path +
                    "' describes no model; a models_info.json is an object from model ids to descriptions");
  std::map<int, ModelInfo> models;
  for (const auto& [key, entry] : json.items())
  {
    const int id = parseId(key);
    if (id < 0)
      fail(path, key, "this is no id; ids are whole numbers of 0 or more");
    try
    {
      if (!models.emplace(id, modelInfoFromJson(entry)).second)
        throw ParameterError("the id occurs twice");
    }
    catch (const ParameterError& error)
    {
      fail(path, key, error.what());
    }
  }
  return models;
}

void saveModelsInfo(const std::map<int, ModelInfo>& models, const std::string& path)
{
  // One line for each model, as the benchmark's own files have it; Json would sort the ids as text.
  std::string text;
  for (const auto& [id, info] : models)
  {
    if (id < 0)
      throw ParameterError("the model id " + std::to_string(id) + " is negative; ids are whole numbers of 0 or more");
    text += (text.empty() ? "" : ",\n") + ("  \"" + std::to_string(id) + "\": ") + toJson(info).dump();
  }
  replaceFile(path, [&](std::ostream& file) { file << "{\n" << text << "\n}\n"; });
}

ModelInfo describeModel(const TriangleMesh& mesh, const Symmetry& symmetry)
{
  if (mesh.empty())
    throw ParameterError("a mesh without triangles has no diameter and no box; load one that has a surface");
  Eigen::Vector3f low = mesh.vertices.front();
  Eigen::Vector3f high = low;
  for (const Eigen::Vector3f& vertex : mesh.vertices)
  {
    low = low.cwiseMin(vertex);
    high = high.cwiseMax(vertex);
  }
  ModelInfo info;
  info.diameter = largestDistance(mesh.vertices);
  info.min_corner = low.cast<double>();
  info.size = high.cast<double>() - info.min_corner;
  info.symmetry = symmetry;
  return info;
}
}  // namespace bin_picking
