// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/common/parameters.hpp"
#include "bin_picking_perception/scene/depth_grid.hpp"

namespace bin_picking::simulation
{
enum class SensorClass
{
  StructuredLight,  ///< camera and projector, as PhoXi, Zivid, COMATRIX
  Stereo,           ///< two cameras and a pattern, as RealSense
  Ideal             ///< every visible point, exactly
};
}  // namespace bin_picking::simulation
