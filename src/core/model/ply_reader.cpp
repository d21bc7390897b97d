// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "ply_reader.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <istream>
#include <limits>
#include <locale>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
enum class Number
{
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Float32,
  Float64
};

[[noreturn]] void fail(const std::string& path, const std::string& what)
{
  throw FileError("cannot read the PLY file '" + path + "': " + what);
}

Number numberType(const std::string& name, const std::string& path)
{
  struct Named
  {
    const char* name;
    Number type;
  };
  static constexpr std::array<Named, 16> NAMES = {{{"char", Number::Int8},
                                                   {"int8", Number::Int8},
                                                   {"uchar", Number::UInt8},
                                                   {"uint8", Number::UInt8},
                                                   {"short", Number::Int16},
                                                   {"int16", Number::Int16},
                                                   {"ushort", Number::UInt16},
                                                   {"uint16", Number::UInt16},
                                                   {"int", Number::Int32},
                                                   {"int32", Number::Int32},
                                                   {"uint", Number::UInt32},
                                                   {"uint32", Number::UInt32},
                                                   {"float", Number::Float32},
                                                   {"float32", Number::Float32},
                                                   {"double", Number::Float64},
                                                   {"float64", Number::Float64}}};
  for (const Named& named : NAMES)
    if (name == named.name)
      return named.type;
  fail(path, "its header has the unknown type '" + name + "'; export it again");
}

/// \param reverse the file's byte order is not this machine's (x86-64 and ARM: little endian)
template <typename T>
bool readBinary(std::istream& file, bool reverse, double& value)
{
  std::array<char, sizeof(T)> bytes;
  if (!file.read(bytes.data(), sizeof(T)))
    return false;
  if (reverse)
    std::reverse(bytes.begin(), bytes.end());
  T typed;
  std::memcpy(&typed, bytes.data(), sizeof(T));
  value = static_cast<double>(typed);
  return true;
}

bool readBinary(std::istream& file, Number type, bool reverse, double& value)
{
  switch (type)
  {
    case Number::Int8:
      return readBinary<std::int8_t>(file, reverse, value);
    case Number::UInt8:
      return readBinary<std::uint8_t>(file, reverse, value);
    case Number::Int16:
      return readBinary<std::int16_t>(file, reverse, value);
    case Number::UInt16:
      return readBinary<std::uint16_t>(file, reverse, value);
    case Number::Int32:
      return readBinary<std::int32_t>(file, reverse, value);
    case Number::UInt32:
      return readBinary<std::uint32_t>(file, reverse, value);
    case Number::Float32:
      return readBinary<float>(file, reverse, value);
    case Number::Float64:
      return readBinary<double>(file, reverse, value);
  }
  return false;
}

/// ASCII exporters write "nan" and "inf", which streams do not read.
bool readAscii(std::istream& file, double& value)
{
  std::string word;
  if (!(file >> word))
    return false;
  std::istringstream in(word);
  in.imbue(std::locale::classic());
  if (!(in >> value) || in.peek() != std::istringstream::traits_type::eof())
  {
    if (word.find("nan") == std::string::npos && word.find("inf") == std::string::npos)
      return false;
    value = std::numeric_limits<double>::quiet_NaN();
  }
  return true;
}

/// Reads the values of one element in the order of the file.
class RowReader
{
public:
  RowReader(std::istream& file, const PlyElement& element, PlyFormat format, const std::string& path)
      : file_(file), element_(element), format_(format), path_(path)
  {
    for (const auto& property : element.properties)
    {
      types_.push_back(numberType(property.type, path));
      count_types_.push_back(property.count_type.empty() ? Number::UInt8 : numberType(property.count_type, path));
    }
  }

  template <typename Sink>
  void read(const Sink& sink)
  {
    // Rows without values take no space in the file: their number is not bounded by it.
    for (row_ = 0; row_ < element_.count && !types_.empty(); ++row_)
      for (std::size_t k = 0; k < types_.size(); ++k)
      {
        const bool is_list = !element_.properties[k].count_type.empty();
        // A list that claims more than the file holds ends at the first missing value.
        for (double left = is_list ? value(count_types_[k]) : 0; left > 0; --left)
          value(types_[k]);
        if (!is_list)
          sink(value(types_[k]));
      }
  }

private:
  double value(Number type)
  {
    double result = 0;
    const bool is_read = format_ == PlyFormat::Ascii
                             ? readAscii(file_, result)
                             : readBinary(file_, type, format_ == PlyFormat::BinaryBigEndian, result);
    if (!is_read)
      fail(path_, "it ends or is damaged in row " + std::to_string(row_ + 1) + " of " + std::to_string(element_.count) +
                      " of '" + element_.name + "'; export or copy it again");
    return result;
  }

  std::istream& file_;
  const PlyElement& element_;
  PlyFormat format_;
  const std::string& path_;
  std::vector<Number> types_;
  std::vector<Number> count_types_;
  std::size_t row_ = 0;
};

PlyFormat formatOf(const std::string& name, const std::string& path)
{
  if (name == "ascii")
    return PlyFormat::Ascii;
  if (name == "binary_little_endian")
    return PlyFormat::BinaryLittleEndian;
  if (name == "binary_big_endian")
    return PlyFormat::BinaryBigEndian;
  fail(path, "its format is '" + name + "', but it must be ascii, binary_little_endian or binary_big_endian");
}

PlyElement elementOf(std::istream& words)
{
  PlyElement element;
  words >> element.name >> element.count;
  return element;
}

PlyProperty propertyOf(std::istream& words)
{
  PlyProperty property;
  words >> property.type;
  if (property.type == "list")
    words >> property.count_type >> property.type;
  words >> property.name;
  return property;
}

void readHeaderLine(const std::string& line, PlyHeader& header, const std::string& path)
{
  std::istringstream words(line);
  std::string keyword;
  words >> keyword;
  if (keyword == "format")
  {
    std::string format;
    words >> format;
    header.format = formatOf(format, path);
  }
  else if (keyword == "element")
    header.elements.push_back(elementOf(words));
  else if (keyword == "property" && !header.elements.empty())
    header.elements.back().properties.push_back(propertyOf(words));
  // Comments and what later exporters may add say nothing about the layout.
  if (!words && (keyword == "element" || keyword == "property"))
    fail(path, "its header has the damaged line '" + line + "'; export it again");
}
}  // namespace

int PlyElement::column(const std::string& property) const
{
  int index = 0;
  for (const auto& candidate : properties)
  {
    if (!candidate.count_type.empty())
      continue;
    if (candidate.name == property)
      return index;
    ++index;
  }
  return -1;
}

const PlyElement* PlyHeader::find(const std::string& element) const
{
  const auto found =
      std::find_if(elements.begin(), elements.end(), [&](const PlyElement& e) { return e.name == element; });
  return found == elements.end() ? nullptr : &*found;
}

PlyHeader readPlyHeader(std::istream& file, const std::string& path)
{
  constexpr int MAX_HEADER_LINES = 10000;
  PlyHeader header;
  std::string line;
  for (int i = 0; i < MAX_HEADER_LINES && std::getline(file, line); ++i)
  {
    if (!line.empty() && line.back() == '\r')
      line.pop_back();
    if (i == 0 && line != "ply")
      break;
    if (line == "end_header")
      return header;
    readHeaderLine(line, header, path);
  }
  fail(path, "it does not begin with a PLY header; check that it is the right file");
}

std::vector<double> readPlyElement(std::istream& file, const PlyHeader& header, const std::string& element,
                                   const std::string& path)
{
  for (const PlyElement& candidate : header.elements)
  {
    const bool wanted = candidate.name == element;
    std::vector<double> values;
    RowReader(file, candidate, header.format, path).read([&](double value) {
      if (wanted)
        values.push_back(value);
    });
    if (wanted)
      return values;
  }
  fail(path, "it has no element '" + element + "'; export points or vertices");
}
}  // namespace bin_picking
