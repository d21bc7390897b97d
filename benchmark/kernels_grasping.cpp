// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/grasping/grasp_planner.hpp"
#include "bin_picking_perception/robot/robot.hpp"
#include "kernels.hpp"

namespace bin_picking::kernels
{
namespace
{
constexpr char ROBOT[] = BIN_PICKING_SOURCE_DIR "/config/robots/ur5e.yaml";

/// As in launch/ur5e_picking.launch.
const Pose T_BASE_LINK_CAMERA = Eigen::Translation3d(0.5, 0.1116, 0.8922) *
                                Eigen::Quaterniond(0.069943, 0.997551, 0, 0).normalized();  // w, x, y, z

/// What a cell's planner is given after detection: the whole bin's detections, the cloud's grid, and an arm beside.
struct Cell
{
  Detector detector;
  DetectionResult result;
  Pose T_base_camera;
};

Cell makeCell()
{
  const Workbench& bench = workbench();
  Detector detector({bench.model}, bench.parameters);
  Detector::Request request;
  request.bin = bench.bin;
  DetectionResult result = detector.detect(bench.raw, request);
  const Robot robot = loadRobot(ROBOT);
  return {std::move(detector), std::move(result), robot.T_base_link_base.inverse() * T_BASE_LINK_CAMERA};
}

const Cell& cell()
{
  static const Cell made = makeCell();
  return made;
}

GraspPlanner plannerWith(int num_threads)
{
  GraspPlanner::Setup setup;
  setup.parts = {workbench().part};
  setup.gripper = loadGripper(BIN_PICKING_SOURCE_DIR "/config/grippers/ag95.yaml");
  setup.robot = loadRobot(ROBOT);
  setup.num_threads = num_threads;
  return GraspPlanner(setup);
}

/// All that detection's answer still lacks: on so many threads.
void graspsOfBin(benchmark::State& state)
{
  const GraspPlanner planner = plannerWith(static_cast<int>(state.range(0)));
  const GraspPlanner::Scene scene{cell().result, cell().detector.models(), &workbench().bin, cell().T_base_camera};
  GraspSelection selection;
  for (auto _ : state)
    benchmark::DoNotOptimize(selection = planner.plan(scene, {}));
  state.counters["detections"] = static_cast<double>(cell().result.detections.size());
  state.counters["allowed"] = static_cast<double>(selection.grasps.size());
  state.counters["rejected"] = static_cast<double>(selection.rejected.size());
}
BENCHMARK(graspsOfBin)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

void obstaclesOfBin(benchmark::State& state)
{
  std::vector<PlacedPart> parts;
  for (const Detection& detection : cell().result.detections)
    parts.push_back({workbench().model.get(), detection.T_camera_object});
  const ObstacleParameters parameters;
  for (auto _ : state)
    benchmark::DoNotOptimize(
        Obstacles(cell().result.surroundings.get(), &workbench().bin, parts, parameters, workbench().executor));
}
BENCHMARK(obstaclesOfBin)->Unit(benchmark::kMillisecond);
}  // namespace
}  // namespace bin_picking::kernels
