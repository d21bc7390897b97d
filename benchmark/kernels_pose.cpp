// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/icp.hpp"
#include "bin_picking_perception/refinement/rivals.hpp"
#include "bin_picking_perception/refinement/verification.hpp"
#include "kernels.hpp"

namespace bin_picking::kernels
{
namespace
{
constexpr std::size_t ICP_PIXELS = 1500;    // as many as detection takes, ...
constexpr std::size_t COARSE_PIXELS = 500;  // ... and for the first half of the iterations
constexpr std::size_t TEST_POINTS = 1500;

/// Calls work(pose) for every pose of the workbench in each iteration.
template <typename Work>
void forEachPose(benchmark::State& state, const Work& work)
{
  const std::vector<Pose>& poses = workbench().poses;
  for (auto _ : state)
    for (const Pose& pose : poses)
      work(pose);
  countPer(state, "pose", poses.size());
}

Pose refined(const Pose& T_camera_object, std::size_t pixels, const IcpParameters& icp)
{
  const Workbench& bench = workbench();
  const MeasuredPart measured =
      measuredNear(*bench.model, T_camera_object, bench.scene.grid, bench.scene.normals, bench.scene.edges, pixels);
  return icpDistanceField(*bench.model, measured, T_camera_object, icp).T_camera_object;
}

Pose refined(const Pose& T_camera_object) { return refined(T_camera_object, ICP_PIXELS, workbench().parameters.icp); }

/// As rivals are, before they are judged.
Pose refinedRoughly(const Pose& T_camera_object)
{
  IcpParameters icp = workbench().parameters.icp;
  icp.max_iterations = (icp.max_iterations + 1) / 2;
  return refined(T_camera_object, COARSE_PIXELS, icp);
}

void icp(benchmark::State& state)
{
  forEachPose(state, [](const Pose& pose) { benchmark::DoNotOptimize(refined(pose)); });
}
BENCHMARK(icp)->Unit(benchmark::kMillisecond);

void pointsInView(benchmark::State& state)
{
  forEachPose(state, [](const Pose& pose) { benchmark::DoNotOptimize(visiblePoints(*workbench().model, pose)); });
}
BENCHMARK(pointsInView)->Unit(benchmark::kMillisecond);

void evidence(benchmark::State& state)
{
  const Workbench& bench = workbench();
  std::vector<TestPoints> visible;
  for (const Pose& pose : bench.poses)
    visible.push_back(testPoints(*bench.model, thinned(visiblePoints(*bench.model, pose), TEST_POINTS)));
  std::size_t k = 0;
  forEachPose(state, [&](const Pose& pose) {
    benchmark::DoNotOptimize(gatherEvidence(visible[k++ % visible.size()], pose, bench.scene.grid,
                                            bench.scene.surroundings, bench.scene.normals, bench.tolerance,
                                            bench.parameters.verification));
  });
}
BENCHMARK(evidence)->Unit(benchmark::kMillisecond);

void outline(benchmark::State& state)
{
  const Workbench& bench = workbench();
  const double leaf = bench.model->parameters.leaf;
  std::vector<SurfaceIndices> visible;
  for (const Pose& pose : bench.poses)
    visible.push_back(visiblePoints(*bench.model, pose));
  std::size_t k = 0;
  forEachPose(state, [&](const Pose& pose) {
    benchmark::DoNotOptimize(
        gatherOutlineEvidence(*bench.model, visible[k++ % visible.size()], pose, bench.scene.surroundings, leaf, leaf));
  });
}
BENCHMARK(outline)->Unit(benchmark::kMillisecond);

void shareOfSurface(benchmark::State& state)
{
  const Workbench& bench = workbench();
  forEachPose(state, [&](const Pose& pose) {
    benchmark::DoNotOptimize(surfaceShare(*bench.model, pose, bench.scene.grid, bench.tolerance));
  });
}
BENCHMARK(shareOfSurface)->Unit(benchmark::kMillisecond);

void rivals(benchmark::State& state)
{
  const Workbench& bench = workbench();
  std::vector<Pose> settled;  // rivals are asked about refined poses
  for (const Pose& pose : bench.poses)
    settled.push_back(refined(pose));
  std::size_t k = 0;
  forEachPose(state, [&](const Pose&) {
    benchmark::DoNotOptimize(chooseAmongRivals(*bench.model, settled[k++ % settled.size()], bench.scene.grid,
                                               bench.scene.surroundings, bench.tolerance,
                                               bench.parameters.verification.min_turn_margin, refinedRoughly));
  });
}
BENCHMARK(rivals)->Unit(benchmark::kMillisecond);

/// The whole of what a pose from the clusters goes through.
void refineAndVerifyPoses(benchmark::State& state)
{
  const Workbench& bench = workbench();
  SearchRegion region;
  std::vector<Hypothetical> poses;
  for (const Pose& pose : bench.poses)
    poses.push_back({pose, 1, &region});
  const int cell = comparisonCell(bench.raw, {bench.model});
  for (auto _ : state)
  {
    DetectionResult result;
    StageClock clock(result);
    bool partial = false;
    benchmark::DoNotOptimize(refineAndVerify(poses, bench.scene, *bench.model, bench.parameters, cell, Deadline(0),
                                             bench.executor, clock, partial));
  }
  countPer(state, "pose", poses.size());
}
BENCHMARK(refineAndVerifyPoses)->Unit(benchmark::kMillisecond);
}  // namespace
}  // namespace bin_picking::kernels
