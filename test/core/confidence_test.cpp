// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/confidence.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace bin_picking
{
namespace
{
/// What a free part shows at its true pose.
PoseQuality good()
{
  PoseQuality quality;
  quality.inlier_share = 0.96;
  quality.violation_share = 0.002;
  quality.visible_fraction = 0.8;
  quality.surface_share = 0.95;
  quality.outline_share = 0.8;
  quality.turn_margin = 100;
  return quality;
}

/// A tenth of a pose's quality taken away or what speaks against it added: one term falls, and more must never make the
/// pose surer.
void expectLess(const std::string& fallen, void (*spoil)(PoseQuality&))
{
  SCOPED_TRACE(fallen);
  PoseQuality quality = good();
  for (int k = 0; k < 8; ++k)
  {
    const double before = confidence(quality);
    spoil(quality);
    EXPECT_LE(confidence(quality), before) << "step " << k;
  }
  EXPECT_LT(confidence(quality), confidence(good()));
  const std::vector<ConfidenceTerm> terms = confidenceTerms(quality);
  const std::vector<ConfidenceTerm> terms_of_good = confidenceTerms(good());
  for (std::size_t k = 0; k < terms.size(); ++k)
    if (terms[k].name == fallen)
      EXPECT_LT(terms[k].value, terms_of_good[k].value);
    else
      EXPECT_EQ(terms[k].value, terms_of_good[k].value) << terms[k].name;
}

TEST(Confidence, isHighForATruePoseAndLowForNothing)
{
  EXPECT_GT(confidence(good()), 0.95);
  EXPECT_LE(confidence(good()), 1);
  EXPECT_LT(confidence({}), 1e-3);
  EXPECT_GE(confidence({}), 0);
}

TEST(Confidence, fallsWithWhateverSpeaksAgainstThePose)
{
  expectLess("visible_fraction", [](PoseQuality& q) { q.visible_fraction -= 0.08; });
  expectLess("violation_share", [](PoseQuality& q) { q.violation_share += 0.05; });
  expectLess("surface_share", [](PoseQuality& q) { q.surface_share -= 0.1; });
  expectLess("outline_share", [](PoseQuality& q) { q.outline_share -= 0.1; });
  expectLess("turn_margin", [](PoseQuality& q) { q.turn_margin /= 10; });
  expectLess("bin_penetration", [](PoseQuality& q) { q.bin_penetration += 0.002; });
}

TEST(Confidence, withoutARivalThereIsNoDoubtAboutTheTurn)
{
  PoseQuality alone = good();
  alone.turn_margin = std::numeric_limits<double>::infinity();
  EXPECT_GE(confidence(alone), confidence(good()));
  EXPECT_LE(confidence(alone), 1);
}
}  // namespace
}  // namespace bin_picking
