// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// What the steps of training and detection cost, each by itself, on one thread: time per pixel, pair, vote, pose.
// Usage: benchmark_kernels [--benchmark_filter=REGEX] [--benchmark_repetitions=N] [--benchmark_out=FILE]
#include "kernels.hpp"

#include <random>

#include "virtual_cell.hpp"

namespace bin_picking::kernels
{
namespace
{
constexpr std::uint32_t SEED = 7;
constexpr int PARTS = 25;

Pose disturbed(const Pose& T_camera_object, const Eigen::Vector3d& center, std::mt19937& random)
{
  std::normal_distribution<double> offset(0, 0.001);  // metres
  std::normal_distribution<double> turn(0, 0.04);     // rad
  // One after the other: the order in which arguments are evaluated is not fixed.
  Eigen::Vector3d shift;
  Eigen::Vector3d rotation;
  for (int k = 0; k < 3; ++k)
  {
    shift[k] = offset(random);
    rotation[k] = turn(random);
  }
  const Eigen::Translation3d to_center(center);
  return Eigen::Translation3d(shift) * T_camera_object * to_center *
         Eigen::AngleAxisd(rotation.norm(), rotation.normalized()) * to_center.inverse();
}

void scanBin(Workbench& bench)
{
  const auto mesh = std::make_shared<TriangleMesh>(loadMesh(bench.part.mesh_file, bench.part.mesh_unit));
  simulation::VirtualCell cell({{bench.part.name, mesh}}, simulation::CellParameters());
  cell.fill({PARTS}, SEED);
  simulation::CellScan scan = cell.scan(SEED);
  bench.bin = cell.bin();
  bench.raw = std::move(scan.scan.grid);
  std::mt19937 random(SEED);
  for (const auto& instance : scan.instances)
    if (instance.view.visible_fraction >= 0.5)
      bench.poses.push_back(disturbed(instance.T_camera_object, bench.model->center, random));
}

Workbench makeWorkbench()
{
  Workbench bench;
  bench.part = loadPart(BIN_PICKING_SOURCE_DIR "/config/parts/three_way_tube");
  bench.model = trainPart(bench.part, {}, Executor(0));
  scanBin(bench);
  DetectionResult ignored;
  StageClock clock(ignored);
  bench.scene = reduceScene(bench.raw, &bench.bin, *bench.model, bench.parameters, bench.executor, clock);
  describeScene(bench.scene, *bench.model, bench.parameters, bench.executor, clock);
  const VerificationParameters& verification = bench.parameters.verification;
  bench.tolerance =
      verification.depth_tolerance * bench.model->parameters.leaf + verification.noise_tolerance * bench.scene.noise;
  return bench;
}
}  // namespace

const Workbench& workbench()
{
  static const Workbench bench = makeWorkbench();
  return bench;
}
}  // namespace bin_picking::kernels

BENCHMARK_MAIN();
