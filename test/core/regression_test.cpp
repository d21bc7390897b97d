// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// A small part of the regression set (benchmark/regression.sh): the whole way from CAD over a settled pile and the
// virtual sensor to judged detections. It gates on counts; times belong to the benchmark.
#include <gtest/gtest.h>

#include <algorithm>

#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/evaluation/scene_judgement.hpp"
#include "bin_picking_perception/model/part.hpp"
#include "virtual_cell.hpp"

namespace bin_picking
{
namespace
{
using simulation::CellParameters;
using simulation::CellPart;
using simulation::CellScan;
using simulation::VirtualCell;

constexpr int FULL = 16;

struct Counts
{
  int pickable = 0;  ///< parts at least half visible
  int found = 0;     ///< of those
  int wrong = 0;     ///< poses that hit no part, or one that was hit already
};

class RegressionPart
{
public:
  explicit RegressionPart(const std::string& name)
      : definition_(loadPart(std::string(BIN_PICKING_SOURCE_DIR) + "/config/parts/" + name)),
        mesh_(std::make_shared<TriangleMesh>(loadMesh(definition_.mesh_file, definition_.mesh_unit))),
        detector_({trainPart(definition_, {}, Executor(2))}, DetectorParameters::preset("fast"))
  {
    shapes_.emplace(name, makePartShape(*mesh_, definition_.symmetry));
  }

  const std::string& name() const { return definition_.name; }
  CellPart cellPart() const { return {name(), mesh_}; }

  Counts countIn(VirtualCell& cell, std::uint32_t seed) const
  {
    const CellScan scan = cell.scan(seed);
    Detector::Request request;
    request.bin = cell.bin();
    std::vector<PoseEstimate> estimates;
    for (const Detection& detection : detector_.detect(scan.scan.grid, request).detections)
      estimates.push_back({detection.part, detection.T_camera_object, detection.score, detection.undetermined_turn});
    EvaluationScene scene;
    scene.parts = {name()};
    for (const auto& instance : scan.instances)
      if (cell.parts()[static_cast<std::size_t>(instance.part)].name == name())
        scene.instances.push_back({name(), instance.T_camera_object, instance.view.visible_fraction});
    const JudgedScene judged = judgeScene(scene, estimates, shapes_, EvaluationParameters());
    Counts counts;
    for (std::size_t k = 0; k < scene.instances.size(); ++k)
      if (scene.instances[k].visible_fraction >= 0.5)
      {
        ++counts.pickable;
        counts.found += judged.found_by[k].has_value() ? 1 : 0;
      }
    counts.wrong = static_cast<int>(std::count_if(judged.estimates.begin(), judged.estimates.end(),
                                                  [](const auto& estimate) { return !estimate.isHit(); }));
    return counts;
  }

private:
  PartDefinition definition_;
  std::shared_ptr<const TriangleMesh> mesh_;
  Detector detector_;
  PartShapes shapes_;
};

/// What a part reaches today; a change that reaches more may demand more.
struct Expectation
{
  const char* part;
  int missed;  ///< at most, of the pickable parts of a full bin
  int wrong;   ///< at most
};

void PrintTo(const Expectation& expectation, std::ostream* out) { *out << expectation.part; }

class Regression : public testing::TestWithParam<Expectation>
{
};

TEST_P(Regression, FindsThePartsOfAFullBinAndALonePartAndNothingInAnEmptyBin)
{
  const RegressionPart part(GetParam().part);
  VirtualCell cell({part.cellPart()}, CellParameters());
  EXPECT_EQ(part.countIn(cell, 1).wrong, 0) << "in an empty bin";

  cell.fill({1}, 2);
  const Counts lone = part.countIn(cell, 2);
  EXPECT_EQ(lone.found, 1) << "of a lone part";
  EXPECT_EQ(lone.wrong, 0) << "beside a lone part";

  cell.clear();
  cell.fill({FULL}, 3);
  const Counts full = part.countIn(cell, 3);
  EXPECT_GE(full.pickable, FULL / 2);
  EXPECT_LE(full.pickable - full.found, GetParam().missed) << "of " << full.pickable << " in a full bin";
  EXPECT_LE(full.wrong, GetParam().wrong) << "in a full bin";
}

INSTANTIATE_TEST_SUITE_P(Parts, Regression,
                         testing::Values(Expectation{"three_way_tube", 1, 1}, Expectation{"pipe_elbow", 0, 0},
                                         Expectation{"hex_bolt", 0, 0}, Expectation{"cast_handle", 0, 0},
                                         Expectation{"stepped_shaft", 0, 0}),
                         [](const auto& test) { return std::string(test.param.part); });

TEST(Regression, FindsNothingInABinFullOfAnotherPart)
{
  const RegressionPart searched("hex_bolt");
  const RegressionPart present("three_way_tube");
  VirtualCell cell({present.cellPart()}, CellParameters());
  cell.fill({FULL}, 4);
  EXPECT_EQ(searched.countIn(cell, 4).wrong, 0);
}
}  // namespace
}  // namespace bin_picking
