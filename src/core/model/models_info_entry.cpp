// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "models_info_entry.hpp"

#include <Eigen/SVD>
#include <array>
#include <cmath>

#include "../common/parameter_text.hpp"
#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/figures.hpp"
#include "part_size.hpp"
#include "symmetry_group.hpp"

namespace bin_picking
{
namespace
{
using Json = nlohmann::json;

constexpr double MM_PER_METRE = 1000;
constexpr std::array<const char*, 3> MIN_KEYS = {"min_x", "min_y", "min_z"};
constexpr std::array<const char*, 3> SIZE_KEYS = {"size_x", "size_y", "size_z"};
/// The entries of files with three decimals are within it.
constexpr double RIGID_TOLERANCE = 2e-3;
/// Half the smallest turn of the largest group that closeUnderComposition accepts: two elements nearer than that can
/// only be one that was measured twice.
constexpr double FITTED_ANGLE = 1.5 * M_PI / 180;
constexpr double FITTED_POSITION_SHARE = 0.01;  // of the diameter
/// Diameters are measured between some of the points and come out a little short.
constexpr double DIAMETER_SLACK = 1.01;

std::string shown(const Json& json)
{
  return json.is_primitive() ? json.dump() : std::string("an ") + json.type_name();
}

double number(const Json& json, const std::string& what)
{
  if (!json.is_number() || !std::isfinite(json.get<double>()))
    throw ParameterError(what + " is " + shown(json) + ", but it must be a finite number");
  return json.get<double>();
}

double field(const Json& json, const std::string& key)
{
  if (!json.contains(key))
    throw ParameterError("'" + key + "' is missing; every model needs diameter, min_x ... and size_x ...");
  return number(json[key], "'" + key + "'") / MM_PER_METRE;
}

template <std::size_t N>
std::array<double, N> numbers(const Json& json, const std::string& what)
{
  if (!json.is_array() || json.size() != N)
    throw ParameterError(what + " must be a list of " + std::to_string(N) + " numbers, but " +
                         (json.is_array() ? "it has " + std::to_string(json.size()) : "is " + shown(json)));
  std::array<double, N> values;
  for (std::size_t i = 0; i < N; ++i)
    values[i] = number(json[i], what + "[" + std::to_string(i) + "]");
  return values;
}

Eigen::Vector3d vector(const Json& json, const char* key, const std::string& what)
{
  if (!json.is_object() || !json.contains(key))
    throw ParameterError(what + " has no '" + key + "'; an axis of revolution needs 'axis' and 'offset'");
  return Eigen::Vector3d(numbers<3>(json[key], what + "." + key).data());
}

/// Entries of a list that may be absent; programs in Python also write null.
std::vector<Json> list(const Json& json, const std::string& key)
{
  if (!json.contains(key) || json[key].is_null())
    return {};
  if (!json[key].is_array())
    throw ParameterError("'" + key + "' is " + shown(json[key]) + ", but it must be a list");
  return json[key].get<std::vector<Json>>();
}

Pose rigidMotion(const Json& json, const std::string& what)
{
  const auto values = numbers<16>(json, what);
  const Eigen::Matrix4d T = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(values.data());
  const Eigen::Matrix3d R = T.topLeftCorner<3, 3>();
  const double skew = (R.transpose() * R - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (skew > RIGID_TOLERANCE)
    throw ParameterError(what + " is no rotation: its columns miss unit length or right angles by " +
                         roundedText(skew, 4) + ", and at most " + formatNumber(RIGID_TOLERANCE) + " is allowed");
  if (R.determinant() < 0)
    throw ParameterError(what + " mirrors the model; only rotations are symmetries that a pose can have");
  if ((T.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() > RIGID_TOLERANCE)
    throw ParameterError(what +
                         " has a last row other than 0, 0, 0, 1; matrices are given row by row, translation last");
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(R, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Pose motion = Pose::Identity();
  motion.linear() = svd.matrixU() * svd.matrixV().transpose();
  motion.translation() = T.topRightCorner<3, 1>() / MM_PER_METRE;
  return motion;
}

Symmetry::Axis revolution(const Json& json, const std::string& what)
{
  const Eigen::Vector3d axis = vector(json, "axis", what);
  if (!(std::abs(axis.norm() - 1) <= RIGID_TOLERANCE))
    throw ParameterError(what + ".axis has the length " + formatNumber(axis.norm()) + ", but it must be a unit vector");
  return {axis.normalized(), vector(json, "offset", what) / MM_PER_METRE};
}

Symmetry readSymmetry(const Json& json, double diameter)
{
  const SymmetryTolerance tolerance = {FITTED_ANGLE, FITTED_POSITION_SHARE * diameter};
  const std::vector<Json> axes = list(json, "symmetries_continuous");
  if (axes.size() > 1)
    throw ParameterError("'symmetries_continuous' has " + std::to_string(axes.size()) +
                         " axes, but a part with an orientation has at most one axis of revolution");
  std::optional<Symmetry::Axis> axis;
  if (!axes.empty())
    axis = revolution(axes.front(), "symmetries_continuous[0]");
  std::vector<Pose> rotations;
  for (const Json& entry : list(json, "symmetries_discrete"))
  {
    const std::string what = "symmetries_discrete[" + std::to_string(rotations.size()) + "]";
    rotations.push_back(rigidMotion(entry, what));
    if (axis && !keepsAxis(rotations.back(), *axis, tolerance))
      throw ParameterError(what + " moves the axis of revolution; it must turn about that axis or reverse it");
  }
  return generateSymmetry(rotations, axis, tolerance);
}

void requireBox(const ModelInfo& info)
{
  if (!(info.diameter >= MIN_PART_DIAMETER && info.diameter <= MAX_PART_DIAMETER))
    throw ParameterError("the diameter is " + formatNumber(info.diameter * MM_PER_METRE) + " mm, but it must lie in [" +
                         formatNumber(MIN_PART_DIAMETER * MM_PER_METRE) + ", " +
                         formatNumber(MAX_PART_DIAMETER * MM_PER_METRE) + "] mm; the file holds millimetres");
  for (std::size_t k = 0; k < 3; ++k)
    if (const double size = info.size[static_cast<int>(k)]; !(size >= 0 && size <= info.diameter * DIAMETER_SLACK))
      throw ParameterError(std::string("'") + SIZE_KEYS[k] + "' is " + formatNumber(size * MM_PER_METRE) +
                           " mm, but it must lie in [0, " + formatNumber(info.diameter * MM_PER_METRE) +
                           "] mm: no side of the box is longer than the diameter");
  if (!info.min_corner.allFinite())
    throw ParameterError("the corner of the box is not finite; compute it from the vertices of the mesh");
}

/// Without what the sines and cosines of round angles leave behind, and without -0.
double tidied(double value) { return std::round(value * 1e12) / 1e12 + 0.0; }

Json toJson(const Eigen::Vector3d& v) { return {tidied(v.x()), tidied(v.y()), tidied(v.z())}; }

Json toJson(const Pose& motion)
{
  Eigen::Matrix4d T = motion.matrix();
  T.topRightCorner<3, 1>() *= MM_PER_METRE;
  Json values = Json::array();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      values.push_back(tidied(T(row, column)));
  return values;
}
}  // namespace

ModelInfo modelInfoFromJson(const Json& json)
{
  if (!json.is_object())
    throw ParameterError("the entry is " + shown(json) + ", but it must be an object with diameter, min_x ...");
  ModelInfo info;
  info.diameter = field(json, "diameter");
  for (std::size_t k = 0; k < 3; ++k)
  {
    info.min_corner[static_cast<int>(k)] = field(json, MIN_KEYS[k]);
    info.size[static_cast<int>(k)] = field(json, SIZE_KEYS[k]);
  }
  requireBox(info);
  info.symmetry = readSymmetry(json, info.diameter);
  return info;
}

Json toJson(const ModelInfo& info)
{
  requireBox(info);
  Json json;
  json["diameter"] = tidied(info.diameter * MM_PER_METRE);
  for (std::size_t k = 0; k < 3; ++k)
  {
    json[MIN_KEYS[k]] = tidied(info.min_corner[static_cast<int>(k)] * MM_PER_METRE);
    json[SIZE_KEYS[k]] = tidied(info.size[static_cast<int>(k)] * MM_PER_METRE);
  }
  const std::vector<Pose>& discrete = info.symmetry.discrete;
  for (std::size_t i = 1; i < discrete.size(); ++i)
    json["symmetries_discrete"].push_back(toJson(discrete[i]));
  if (const auto& axis = info.symmetry.continuous)
    json["symmetries_continuous"].push_back(
        {{"axis", toJson(axis->direction)}, {"offset", toJson(Eigen::Vector3d(axis->origin * MM_PER_METRE))}});
  return json;
}
}  // namespace bin_picking
