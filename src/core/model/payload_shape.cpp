// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "payload_shape.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace bin_picking
{
void require(bool condition, const char* what)
{
  if (!condition)
    throw std::runtime_error(what);
}

void write(BinaryWriter& out, const Symmetry& symmetry)
{
  out.value(static_cast<std::uint64_t>(symmetry.discrete.size()));
  for (const Pose& element : symmetry.discrete)
    out.matrix(element.matrix());
  out.value(static_cast<std::uint8_t>(symmetry.continuous ? 1 : 0));
  if (symmetry.continuous)
  {
    out.matrix(symmetry.continuous->direction);
    out.matrix(symmetry.continuous->origin);
  }
}

Symmetry readSymmetry(BinaryReader& in)
{
  Symmetry symmetry;
  symmetry.discrete.assign(in.count(sizeof(Eigen::Matrix4d)), Pose::Identity());
  require(!symmetry.discrete.empty(), "the symmetry lacks the identity");
  for (Pose& element : symmetry.discrete)
    element.matrix() = in.matrix<Eigen::Matrix4d>();
  if (in.value<std::uint8_t>() != 0)
  {
    const auto direction = in.matrix<Eigen::Vector3d>();
    symmetry.continuous = Symmetry::Axis{direction, in.matrix<Eigen::Vector3d>()};
  }
  return symmetry;
}

void write(BinaryWriter& out, const std::vector<std::string>& texts)
{
  out.value(static_cast<std::uint64_t>(texts.size()));
  for (const std::string& text : texts)
    out.text(text);
}

std::vector<std::string> readTexts(BinaryReader& in)
{
  std::vector<std::string> texts(in.count(sizeof(std::uint64_t)));
  for (std::string& text : texts)
    text = in.text();
  return texts;
}

void write(BinaryWriter& out, const TriangleMesh& mesh)
{
  out.vectors(mesh.vertices);
  out.array(mesh.triangles);
  write(out, mesh.repairs);
}

TriangleMesh readMesh(BinaryReader& in)
{
  TriangleMesh mesh;
  mesh.vertices = in.vectors();
  mesh.triangles = in.array<std::array<std::uint32_t, 3>>();
  for (const auto& triangle : mesh.triangles)
    require(*std::max_element(triangle.begin(), triangle.end()) < mesh.vertices.size(),
            "a triangle has a corner that does not exist");
  mesh.repairs = readTexts(in);
  return mesh;
}

void write(BinaryWriter& out, const std::vector<NearSymmetry>& turns)
{
  out.value(static_cast<std::uint64_t>(turns.size()));
  for (const NearSymmetry& turn : turns)
  {
    out.matrix(turn.T_object_object.matrix());
    out.matrix(turn.axis.direction);
    out.matrix(turn.axis.origin);
    out.value(turn.broken);
    out.value(turn.deviation);
    out.value(static_cast<std::uint8_t>(turn.slight ? 1 : 0));
    out.value(static_cast<std::uint8_t>(turn.slight_all_around ? 1 : 0));
  }
}

std::vector<NearSymmetry> readNearSymmetries(BinaryReader& in)
{
  std::vector<NearSymmetry> turns(in.count(sizeof(Eigen::Matrix4d)));
  for (NearSymmetry& turn : turns)
  {
    turn.T_object_object.matrix() = in.matrix<Eigen::Matrix4d>();
    turn.axis.direction = in.matrix<Eigen::Vector3d>();
    turn.axis.origin = in.matrix<Eigen::Vector3d>();
    turn.broken = in.value<double>();
    turn.deviation = in.value<double>();
    turn.slight = in.value<std::uint8_t>() != 0;
    turn.slight_all_around = in.value<std::uint8_t>() != 0;
  }
  return turns;
}
}  // namespace bin_picking
