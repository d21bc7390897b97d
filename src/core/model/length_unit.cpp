// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/model/mesh.hpp"

namespace bin_picking
{
LengthUnit parseLengthUnit(const std::string& text)
{
  for (const LengthUnit unit : {LengthUnit::Metre, LengthUnit::Centimetre, LengthUnit::Millimetre, LengthUnit::Inch})
    if (text == toString(unit))
      return unit;
  throw ParameterError("the length unit is '" + text + "', but it must be one of: m, cm, mm, inch");
}

std::string toString(LengthUnit unit)
{
  switch (unit)
  {
    case LengthUnit::Centimetre:
      return "cm";
    case LengthUnit::Millimetre:
      return "mm";
    case LengthUnit::Inch:
      return "inch";
    case LengthUnit::Metre:
      break;
  }
  return "m";
}

double metresPer(LengthUnit unit)
{
  switch (unit)
  {
    case LengthUnit::Centimetre:
      return 0.01;
    case LengthUnit::Millimetre:
      return 0.001;
    case LengthUnit::Inch:
      return 0.0254;
    case LengthUnit::Metre:
      break;
  }
  return 1;
}
}  // namespace bin_picking
