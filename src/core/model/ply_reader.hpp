// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstddef>
#include <iosfwd>
#include <string>
#include <vector>

namespace bin_picking
{
struct PlyProperty
{
  std::string name;
  std::string type;
  std::string count_type;  ///< of a list; empty: a single value
};

struct PlyElement
{
  std::string name;
  std::size_t count = 0;
  std::vector<PlyProperty> properties;

  /// Place of a property among the single values of a row; -1: there is none.
  int column(const std::string& property) const;
};

enum class PlyFormat
{
  Ascii,
  BinaryLittleEndian,
  BinaryBigEndian
};

struct PlyHeader
{
  PlyFormat format = PlyFormat::Ascii;
  std::vector<PlyElement> elements;

  const PlyElement* find(const std::string& element) const;
};

/// Leaves the stream at the first byte of data. \throws FileError not a PLY header, or a form that is not supported
PlyHeader readPlyHeader(std::istream& file, const std::string& path);

/// The single values of all rows of an element, row after row; the elements before it are skipped.
/// \throws FileError truncated, or not a number
std::vector<double> readPlyElement(std::istream& file, const PlyHeader& header, const std::string& element,
                                   const std::string& path);
}  // namespace bin_picking
