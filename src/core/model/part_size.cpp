// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "part_size.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <limits>
#include <locale>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
/// Thinner than this share of its diameter is flat: a 0.2 m sheet of 0.02 mm is a drawing, not a part.
constexpr double FLAT_SHARE = 1e-4;

constexpr std::array<LengthUnit, 4> ALL_UNITS = {LengthUnit::Metre, LengthUnit::Centimetre, LengthUnit::Millimetre,
                                                 LengthUnit::Inch};

bool fitsABin(double diameter) { return diameter >= MIN_PART_DIAMETER && diameter <= MAX_PART_DIAMETER; }

std::string lengthText(double metres)
{
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(4);
  if (metres < 1)
    text << metres * 1e3 << " mm";
  else
    text << metres << " m";
  return text.str();
}

/// Extent along the direction in which the points spread least.
double thickness(const std::vector<Eigen::Vector3f>& points)
{
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : points)
    mean += p.cast<double>();
  mean /= static_cast<double>(points.size());
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const auto& p : points)
    covariance += (p.cast<double>() - mean) * (p.cast<double>() - mean).transpose();
  const Eigen::Vector3d axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(0);
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const auto& p : points)
  {
    const double t = axis.dot(p.cast<double>() - mean);
    low = std::min(low, t);
    high = std::max(high, t);
  }
  return high - low;
}

std::string unitAdvice(double diameter, LengthUnit unit)
{
  std::string fitting;
  for (const LengthUnit candidate : ALL_UNITS)
  {
    const double other = diameter / metresPer(unit) * metresPer(candidate);
    if (candidate != unit && fitsABin(other))
      fitting += (fitting.empty() ? "'" : " or '") + toString(candidate) + "' (" + lengthText(other) + ")";
  }
  return fitting.empty() ? "no unit makes it fit: check that this is the right file, and scale it in the CAD program"
                         : "set the unit to " + fitting;
}
}  // namespace

void requireReadableFile(const std::string& path)
{
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw FileError("'" + path + "' is a folder, but a file is needed; name the file in it");
  if (!std::ifstream(path, std::ios::binary))
    throw FileError("cannot open '" + path + "': there is no such file, or it may not be read; check the path");
}

void checkPartShape(const std::vector<Eigen::Vector3f>& points, const std::string& path, LengthUnit unit)
{
  const auto broken = std::find_if(points.begin(), points.end(), [](const auto& p) { return !p.allFinite(); });
  if (broken != points.end())
    throw FileError("'" + path + "' has a vertex that is not finite (number " +
                    std::to_string(broken - points.begin() + 1) + "); export it from the CAD program again");
  const double diameter = largestDistance(points);
  if (!fitsABin(diameter))
    throw FileError("'" + path + "' read in '" + toString(unit) + "' has a diameter of " + lengthText(diameter) +
                    ", but parts between " + lengthText(MIN_PART_DIAMETER) + " and " + lengthText(MAX_PART_DIAMETER) +
                    " are supported; " + unitAdvice(diameter, unit));
  if (thickness(points) < FLAT_SHARE * diameter)
    throw FileError("'" + path + "' is flat: all its points lie in one plane, but a part needs a volume; export the " +
                    "solid and not a drawing of it");
}
}  // namespace bin_picking
