// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "bin_picking_perception/detector_parameters.hpp"
#include "bin_picking_perception/model/training_parameters.hpp"

namespace bin_picking
{
namespace
{
/// The published constants of one object, in the paper's units: mm, and the curvature as printed.
struct Published
{
  const char* file;
  double leaf;
  double d_dist;
  double curvature_radius;
  CurvatureMeasure measure;
  double d_cur;
  double low_max;
  double high_min;
  double weight;
  int results;
};

constexpr auto VARIATION = CurvatureMeasure::NormalVariation;
constexpr auto MEAN = CurvatureMeasure::MeanCurvature;

/// Section 3.1 with Figure 12 (the weight is given there as "2 to 8"), and Section 3.2.1.
const Published TABLE[] = {{"bunny", 5, 3, 15, VARIATION, 0.07, 0.02, 0.2, 4, 1},
                           {"dragon", 5, 3, 15, VARIATION, 0.1, 0.07, 0.22, 4, 1},
                           {"statuette", 5, 3, 15, VARIATION, 0.13, 0.1, 0.2, 4, 1},
                           {"chinese_dragon", 5, 3, 15, VARIATION, 0.15, 0.1, 0.24, 4, 1},
                           {"armadillo", 5, 3, 15, VARIATION, 0.2, 0.07, 0.18, 4, 1},
                           {"buddha", 5, 3, 15, VARIATION, 0.11, 0.07, 0.18, 4, 1},
                           {"three_way_tube", 3, 0.5, 10, MEAN, 0.025, 0.015, 0.06, 3, 5},
                           {"upright_column", 3, 0.5, 10, MEAN, 0.3, 0.015, 0.065, 5, 3}};

struct Configuration
{
  TrainingParameters training;
  DetectorParameters detector;

  void visit(ParameterVisitor& v)
  {
    v.group("training", training);
    v.group("detector", detector);
  }
};

std::string readFile(const std::string& path)
{
  std::ifstream file(path);
  EXPECT_TRUE(file) << path;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

class PaperConfig : public testing::TestWithParam<Published>
{
};

TEST_P(PaperConfig, HoldsThePublishedConstants)
{
  const Published& paper = GetParam();
  const std::string path = std::string(BIN_PICKING_SOURCE_DIR "/config/paper/") + paper.file + ".yaml";
  Configuration configuration;
  configuration.detector = DetectorParameters::preset("paper");
  setParametersFromYaml(visitor(configuration), readFile(path), path);

  const TrainingParameters& training = configuration.training;
  constexpr double MM = 1e-3;
  EXPECT_NEAR(training.leaf, paper.leaf * MM, 1e-12);
  EXPECT_NEAR(training.matching_leaf, paper.leaf * MM, 1e-12);
  EXPECT_NEAR(training.d_dist, paper.d_dist * MM, 1e-12);
  EXPECT_NEAR(training.d_angle, 12 * M_PI / 180, 1e-12);
  EXPECT_NEAR(training.curvature_radius, paper.curvature_radius * MM, 1e-12);
  EXPECT_EQ(training.feature, FeatureKind::CurPpf);
  EXPECT_EQ(training.curvature_measure, paper.measure);
  EXPECT_FALSE(training.covisible_pairs);
  EXPECT_FALSE(training.fold_symmetry);
  EXPECT_FALSE(training.curvature_in_views);
  EXPECT_FALSE(training.edge_pairs);
  EXPECT_LT(training.min_pair_distance, 0.01 * paper.leaf * MM);
  EXPECT_GT(training.min_pair_distance, 0) << "0 would mean a distance derived from the leaf";

  const double unit = paper.measure == MEAN ? 1 / MM : 1;  // 1/mm
  EXPECT_NEAR(training.d_cur, paper.d_cur * unit, 1e-9);
  EXPECT_NEAR(training.low_curvature_max, paper.low_max * unit, 1e-9);
  EXPECT_NEAR(training.high_curvature_min, paper.high_min * unit, 1e-9);

  const DetectorParameters& detector = configuration.detector;
  EXPECT_NEAR(detector.voting.reference_share, 1.0 / 5, 1e-12);
  EXPECT_EQ(detector.voting.max_votes, 0);
  EXPECT_EQ(detector.voting.edge_weight, 0);
  EXPECT_FALSE(detector.voting.skip_repeated);
  EXPECT_NEAR(detector.voting.weight, paper.weight, 1e-12);
  EXPECT_NEAR(detector.verification.match_distance, 5 * MM, 1e-12);
  EXPECT_EQ(detector.max_detections, paper.results);
}

INSTANTIATE_TEST_SUITE_P(Objects, PaperConfig, testing::ValuesIn(TABLE),
                         [](const testing::TestParamInfo<Published>& object) {
                           return std::string(object.param.file);
                         });
}  // namespace
}  // namespace bin_picking
