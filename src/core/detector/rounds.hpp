// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <vector>

#include "same_place.hpp"
#include "stages.hpp"

namespace bin_picking
{
/// A pose from votes with what a quick look at the scene says about it.
struct Ranked
{
  Hypothetical pose;
  double score = 0;
  std::vector<int> cells;  ///< that it would explain
};

/// Deals out ranked poses, some at a time. The size of a round does not depend on the number of threads, so neither do
/// the results. Poses and model must outlive it.
class Rounds
{
public:
  /// \param ranked most promising first
  Rounds(const std::vector<Ranked>& ranked, const TrainedModel& model);

  /// The next of all, whatever was found; none when all were dealt out.
  std::vector<const Ranked*> next();

  /// The next that lie where nothing was accepted yet and that nobody was led to. Of poses that a near symmetry leads
  /// to from each other, one: settled among its rivals, it would most likely end where the others would, and they wait
  /// until that is known. \param explained ascending
  std::vector<const Ranked*> next(const std::vector<int>& explained, const std::vector<Assessed>& assessed);

private:
  struct Waiting
  {
    const Ranked* pose;
    Place place;
  };

  std::vector<Place> endsOf(const std::vector<Assessed>& assessed) const;

  SamePlace same_place_;
  SamePlace rivals_;
  std::vector<Waiting> waiting_;  ///< most promising first
};
}  // namespace bin_picking
