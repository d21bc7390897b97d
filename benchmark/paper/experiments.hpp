// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

#include "method.hpp"

namespace bin_picking::paper
{
/// One object in point sets, every method on the same scenes in turn. Specification: {"kind": "points", "objects": [as
/// readObject, the searched one first], "scene": "whole" | "view" | "clutter" | {as readPointScene}, "noise": [...],
/// "trials", "seed", "methods": [...], "picture": file without ending, of the first scene}.
Json runPoints(const Json& specification, const std::string& folder);

/// Bins with truth, every method on the same scenes in turn. {"kind": "bins", "dataset", "parts": [names or folders],
/// "max_scenes", "methods": [...], "picture": file without ending, of the first scene}.
Json runBins(const Json& specification, const std::string& folder);

/// The curvature of a model as a picture and a histogram (the paper's Figures 7 and 12). {"kind": "curvature",
/// "object": as readObject, "method", "picture"}.
Json runCurvature(const Json& specification, const std::string& folder);

/// The stages of Algorithm 1 as pictures (Figure 5 and Figure 16, i to l). {"kind": "segmentation", "dataset", "part",
/// "scene": number, "method", "picture"}.
Json runSegmentation(const Json& specification, const std::string& folder);
}  // namespace bin_picking::paper
