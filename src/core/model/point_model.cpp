// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "part_size.hpp"
#include "ply_reader.hpp"

namespace bin_picking
{
namespace
{
/// x, y, z, nx, ny, nz among the values of a row.
using Columns = std::array<std::size_t, 6>;

bool findColumns(const PlyElement& vertex, Columns& columns)
{
  static constexpr std::array<const char*, 6> NAMES = {"x", "y", "z", "nx", "ny", "nz"};
  for (std::size_t k = 0; k < NAMES.size(); ++k)
  {
    const int column = vertex.column(NAMES[k]);
    if (column < 0)
      return false;
    columns[k] = static_cast<std::size_t>(column);
  }
  return true;
}

std::size_t rowLength(const PlyElement& vertex)
{
  return static_cast<std::size_t>(std::count_if(vertex.properties.begin(), vertex.properties.end(),
                                                [](const PlyProperty& p) { return p.count_type.empty(); }));
}

OrientedPoints fromRows(const std::vector<double>& values, std::size_t row_length, const Columns& columns, double scale)
{
  OrientedPoints result;
  for (std::size_t row = 0; row + row_length <= values.size(); row += row_length)
  {
    const auto at = [&](std::size_t k) { return values[row + columns[k]]; };
    const Eigen::Vector3d point = Eigen::Vector3d(at(0), at(1), at(2)) * scale;
    const Eigen::Vector3d normal(at(3), at(4), at(5));
    if (!point.allFinite() || !normal.allFinite() || !(normal.norm() > 1e-12))
      continue;
    result.points.push_back(point.cast<float>());
    result.normals.push_back(normal.normalized().cast<float>());
  }
  return result;
}
}  // namespace

OrientedPoints loadOrientedPoints(const std::string& path, LengthUnit unit)
{
  requireReadableFile(path);
  std::ifstream file(path, std::ios::binary);
  const PlyHeader header = readPlyHeader(file, path);
  const PlyElement* vertex = header.find("vertex");
  Columns columns = {};
  if (!vertex || !findColumns(*vertex, columns))
    throw FileError("the PLY file '" + path +
                    "' has no points with normals (x y z nx ny nz); estimate the normals in " +
                    "the program that made it and save them too");
  OrientedPoints points =
      fromRows(readPlyElement(file, header, "vertex", path), rowLength(*vertex), columns, metresPer(unit));
  if (points.empty())
    throw FileError("the PLY file '" + path + "' has no point with finite coordinates and a normal; export it again");
  checkPartShape(points.points, path, unit);
  return points;
}

bool isPointModel(const std::string& path)
{
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension != ".ply")
    return false;
  requireReadableFile(path);
  std::ifstream file(path, std::ios::binary);
  const PlyHeader header = readPlyHeader(file, path);
  const PlyElement* vertex = header.find("vertex");
  const PlyElement* face = header.find("face");
  Columns columns = {};
  return vertex && findColumns(*vertex, columns) && (!face || face->count == 0);
}
}  // namespace bin_picking
