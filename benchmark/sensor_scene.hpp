// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "sensor.hpp"

namespace bin_picking::simulation
{
/// The sensor's defaults, with the picture of the real clouds that its class is compared with: the same number of
/// pixels and focal length.
SensorParameters comparisonSensor(SensorClass type);

/// A bin of about the size of those in the real clouds, with boxes and cylinders in it, under that sensor.
std::vector<SceneObject> comparisonScene(SensorClass type, std::uint32_t seed);
}  // namespace bin_picking::simulation
