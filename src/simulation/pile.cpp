// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "pile.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "height_map.hpp"
#include "random.hpp"

namespace bin_picking::simulation
{
namespace
{
constexpr double CELL = 0.001;  // metres: gaps between the parts are about this wide
constexpr int PLACES_PER_ATTITUDE = 6;
constexpr double FIRST_TURN = 0.5;     // rad; the shaking shrinks linearly from here
constexpr double FIRST_SHIFT = 0.015;  // metres

struct Placement
{
  Eigen::Quaterniond rotation;
  PartProfile profile;
  int column = 0;
  int row = 0;
  double z = 0;
  double height = std::numeric_limits<double>::infinity();  // of the centre of mass
};

class Pile
{
public:
  Pile(const TriangleMesh& part, const PileParameters& parameters)
      : part_(part),
        center_(centerOfMass(part)),
        map_(parameters.bin_length, parameters.bin_width, CELL),
        random_(static_cast<std::uint32_t>(parameters.seed))
  {}

  std::optional<Placement> lowestOf(int attempts)
  {
    std::optional<Placement> best;
    for (int attempt = 0; attempt < attempts; ++attempt)
    {
      Placement candidate = attitude(random_.rotation());
      for (int place = 0; place < PLACES_PER_ATTITUDE && fits(candidate.profile); ++place)
      {
        candidate.column = random_.below(map_.columns() - candidate.profile.columns + 1);
        candidate.row = random_.below(map_.rows() - candidate.profile.rows + 1);
        lower(candidate);
        if (!best || candidate.height < best->height)
          best = candidate;
      }
    }
    return best;
  }

  void shake(Placement& placement, int shakes)
  {
    for (int i = 0; i < shakes; ++i)
    {
      const double strength = 1 - static_cast<double>(i) / shakes;
      const Eigen::Vector3d turn = strength * FIRST_TURN / 2 * random_.inBall();
      const Eigen::Vector3d shift = strength * FIRST_SHIFT / CELL * random_.inBall();
      Placement candidate = attitude(
          (Eigen::Quaterniond(1, turn.x(), turn.y(), turn.z()).normalized() * placement.rotation).normalized());
      candidate.column = placement.column + static_cast<int>(std::lround(shift.x()));
      candidate.row = placement.row + static_cast<int>(std::lround(shift.y()));
      if (!inside(candidate))
        continue;
      lower(candidate);
      if (candidate.height < placement.height)
        placement = std::move(candidate);
    }
  }

  Pose add(const Placement& placement)
  {
    map_.add(placement.profile, placement.column, placement.row, placement.z);
    Pose T_bin_object = Pose::Identity();
    T_bin_object.linear() = placement.rotation.toRotationMatrix();
    T_bin_object.translation() = map_.origin(placement.profile, placement.column, placement.row, placement.z);
    return T_bin_object;
  }

private:
  Placement attitude(const Eigen::Quaterniond& rotation) const
  {
    Placement placement;
    placement.rotation = rotation;
    placement.profile = profileOf(part_, rotation, CELL);
    return placement;
  }

  bool fits(const PartProfile& profile) const
  {
    return profile.columns <= map_.columns() && profile.rows <= map_.rows();
  }

  bool inside(const Placement& placement) const
  {
    return placement.column >= 0 && placement.row >= 0 &&
           placement.column + placement.profile.columns <= map_.columns() &&
           placement.row + placement.profile.rows <= map_.rows();
  }

  void lower(Placement& placement) const
  {
    placement.z = map_.restHeight(placement.profile, placement.column, placement.row);
    placement.height = placement.z + (placement.rotation * center_).z();
  }

  const TriangleMesh& part_;
  Eigen::Vector3d center_;
  HeightMap map_;
  Random random_;
};

std::array<Eigen::Vector3d, 3> cornersOf(const TriangleMesh& mesh, const std::array<std::uint32_t, 3>& triangle)
{
  return {mesh.vertices[triangle[0]].cast<double>(), mesh.vertices[triangle[1]].cast<double>(),
          mesh.vertices[triangle[2]].cast<double>()};
}

std::string sizeText(const PileParameters& p)
{
  std::ostringstream out;
  out << p.bin_length << " x " << p.bin_width << " x " << p.bin_height << " m";
  return out.str();
}
}  // namespace

std::vector<Pose> layPile(const TriangleMesh& part, const PileParameters& parameters)
{
  Pile pile(part, parameters);
  std::vector<Pose> T_bin_objects;
  for (int i = 0; i < parameters.count; ++i)
  {
    std::optional<Placement> placement = pile.lowestOf(parameters.attempts);
    if (!placement)
      throw ParameterError("The part does not fit into a bin of " + sizeText(parameters) + " in any of " +
                           std::to_string(parameters.attempts) + " attitudes; take a larger bin.");
    pile.shake(*placement, parameters.shakes);
    if (placement->height > parameters.bin_height)
      throw ParameterError("Part " + std::to_string(i + 1) + " of " + std::to_string(parameters.count) +
                           " would lie above the rim of the bin of " + sizeText(parameters) +
                           "; ask for fewer parts or take a larger bin.");
    T_bin_objects.push_back(pile.add(*placement));
  }
  return T_bin_objects;
}

Eigen::Vector3d centerOfMass(const TriangleMesh& mesh)
{
  Eigen::Vector3d center_of_area = Eigen::Vector3d::Zero();
  double area = 0;
  for (const auto& triangle : mesh.triangles)
  {
    const auto [a, b, c] = cornersOf(mesh, triangle);
    const double doubled_area = (b - a).cross(c - a).norm();
    area += doubled_area / 2;
    center_of_area += doubled_area / 2 * (a + b + c) / 3;
  }
  center_of_area /= area;
  Eigen::Vector3d from_center = Eigen::Vector3d::Zero();
  double volume = 0;
  for (const auto& triangle : mesh.triangles)
  {
    auto [a, b, c] = cornersOf(mesh, triangle);
    a -= center_of_area;
    b -= center_of_area;
    c -= center_of_area;
    const double tetrahedron = a.dot(b.cross(c)) / 6;
    volume += tetrahedron;
    from_center += tetrahedron * (a + b + c) / 4;
  }
  const bool flat = std::abs(volume) < 1e-6 * std::pow(area, 1.5);
  return flat ? center_of_area : Eigen::Vector3d(center_of_area + from_center / volume);
}

void PileParameters::visit(ParameterVisitor& v)
{
  v.field({"count", "", "number of parts in the bin", 0, 1000}, count);
  v.field({"seed", "", "another number gives another pile, the same number the same bits", 0, 2147483647}, seed);
  v.field({"bin_length", "m", "inner length of the bin, along its x axis", 0.02, 2}, bin_length);
  v.field({"bin_width", "m", "inner width of the bin", 0.02, 2}, bin_width);
  v.field({"bin_height", "m", "height of the walls; parts that heap higher are refused", 0, 1}, bin_height);
  v.field({"attempts", "", "random attitudes tried per part; more give a flatter pile", 1, 10000}, attempts);
  v.field({"shakes", "", "small random moves tried per part after it was laid; more let it rest deeper", 0, 10000},
          shakes);
}
}  // namespace bin_picking::simulation
