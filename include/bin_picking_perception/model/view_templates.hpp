// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstdint>
#include <vector>

#include "bin_picking_perception/common/oriented_points.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "bin_picking_perception/model/trained_model.hpp"

namespace bin_picking
{
class Executor;

/// What cameras all around the part see of it, in directions spread evenly over the sphere. The cameras are so far away
/// (200 diameters) that the projection is nearly parallel: sizes in metres then hold for any distance.
/// A surface point is visible if its normal faces the camera (cosine above 0.1) and nothing hides it by more than 1.5
/// pixels, plus what its slant makes within a pixel.
/// The result does not depend on the executor.
/// \param mesh empty: the surface points are drawn as discs of radius 2 pixels, so the pixel should be half their
/// distance \param pixel edge of a pixel at the part, metres \throws ParameterError no views, no points, or a pixel too
/// small or too large for the part
std::vector<ViewTemplate> renderViewTemplates(const TriangleMesh& mesh, const OrientedPoints& surface, double pixel,
                                              int num_views, const Executor& executor);

/// Per surface point 1 if at least one view sees it; the others lie inside the part.
std::vector<std::uint8_t> seenByAnyView(const std::vector<ViewTemplate>& views, std::size_t num_surface_points);

/// Length in pixels of all contours of a region, those of its holes included: an estimate of the length of the curve
/// that was digitised (Vossepoel and Smeulders 1982), not a count of its pixels. \param mask row-major, 0: outside
double contourLength(const std::vector<std::uint8_t>& mask, int width, int height);
}  // namespace bin_picking
