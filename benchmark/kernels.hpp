// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <benchmark/benchmark.h>

#include <memory>
#include <vector>

#include "../src/core/detector/stages.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/part.hpp"

namespace bin_picking::kernels
{
/// What the kernels work on: a virtual scan of a bin full of tees, the same on every run, and the trained tee. Made
/// when it is first asked for.
struct Workbench
{
  PartDefinition part;
  std::shared_ptr<const TrainedModel> model;
  DetectorParameters parameters;
  Bin bin;
  DepthGrid raw;
  PreparedScene scene;
  /// Near the true poses of parts that are at least half visible, as voting finds them: off by a millimetre or two and
  /// a few degrees.
  std::vector<Pose> poses;
  double tolerance = 0;  ///< of the distance to the surface in verification, metres
  Executor executor;     ///< one thread: what a unit of work costs
};

const Workbench& workbench();

/// Shows what one unit took, for a benchmark that did so many in each iteration.
inline void countPer(benchmark::State& state, const char* unit, std::size_t per_iteration)
{
  state.counters[std::string("per_") + unit] = benchmark::Counter(
      static_cast<double>(per_iteration), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
}  // namespace bin_picking::kernels
