// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <string>

#include "bin_picking_perception/evaluation/scene_judgement.hpp"
#include "bin_picking_perception/evaluation/scene_picture.hpp"

namespace bin_picking
{
/// How many of each kind a scene has.
struct SceneCounts
{
  int hits = 0;
  int duplicates = 0;
  int wrong = 0;
  int missed = 0;

  bool flawless() const { return duplicates + wrong + missed == 0; }
};

SceneCounts countsOf(const JudgedScene& scene, double lowest_level);

/// The kinds by which a scene can be filtered, as words: wrong, missed, duplicate, flawed, flawless.
std::string sceneKinds(const SceneCounts& counts);

/// A scene of the page: its picture with the outlines over it, and what was found.
std::string sceneCard(const JudgedScene& scene, const ScenePicture& picture, double lowest_level);
}  // namespace bin_picking
