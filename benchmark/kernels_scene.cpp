// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include "bin_picking_perception/scene/cloud_input.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"
#include "kernels.hpp"

namespace bin_picking::kernels
{
namespace
{
pcl::PointCloud<pcl::PointXYZ> cloudOf(const DepthGrid& grid)
{
  pcl::PointCloud<pcl::PointXYZ> cloud(static_cast<std::uint32_t>(grid.width), static_cast<std::uint32_t>(grid.height));
  for (std::size_t i = 0; i < grid.size(); ++i)
    cloud.points[i] = {grid.x[i], grid.y[i], grid.z[i]};
  return cloud;
}

void cloudCheck(benchmark::State& state)
{
  const Workbench& bench = workbench();
  const pcl::PointCloud<pcl::PointXYZ> cloud = cloudOf(bench.raw);
  for (auto _ : state)
    benchmark::DoNotOptimize(viewOf(cloud, bench.parameters.input));
}
BENCHMARK(cloudCheck)->Unit(benchmark::kMillisecond);

void cloudReduction(benchmark::State& state)
{
  const Workbench& bench = workbench();
  const pcl::PointCloud<pcl::PointXYZ> cloud = cloudOf(bench.raw);
  const PointView points = viewOf(cloud, bench.parameters.input);
  for (auto _ : state)
    benchmark::DoNotOptimize(reduceGrid(points, bench.scene.reduction, bench.executor));
  countPer(state, "pixel", points.size());
}
BENCHMARK(cloudReduction)->Unit(benchmark::kMillisecond);

void outlierRemoval(benchmark::State& state)
{
  const Workbench& bench = workbench();
  DepthGrid cropped = bench.scene.surroundings;
  cropToRegion(cropped, bench.parameters.input, &bench.bin, bench.executor);
  for (auto _ : state)
  {
    state.PauseTiming();
    DepthGrid grid = cropped;
    state.ResumeTiming();
    removeOutliers(grid, bench.parameters.preprocessing, bench.executor);
    benchmark::DoNotOptimize(grid);
  }
  countPer(state, "pixel", cropped.size());
}
BENCHMARK(outlierRemoval)->Unit(benchmark::kMillisecond);

void connectivity(benchmark::State& state)
{
  const Workbench& bench = workbench();
  for (auto _ : state)
    benchmark::DoNotOptimize(connectedRuns(bench.scene.grid, EdgeRule(), bench.executor));
  countPer(state, "pixel", bench.scene.grid.size());
}
BENCHMARK(connectivity)->Unit(benchmark::kMillisecond);

void depthNoise(benchmark::State& state)
{
  const Workbench& bench = workbench();
  for (auto _ : state)
    benchmark::DoNotOptimize(estimateDepthNoise(bench.scene.grid, bench.scene.runs));
  countPer(state, "pixel", bench.scene.grid.size());
}
BENCHMARK(depthNoise)->Unit(benchmark::kMillisecond);

void normals(benchmark::State& state)
{
  const Workbench& bench = workbench();
  for (auto _ : state)
    benchmark::DoNotOptimize(
        estimateGridNormals(bench.scene.grid, bench.scene.runs, bench.model->parameters.normal_radius, bench.executor));
  countPer(state, "pixel", bench.scene.grid.size());
}
BENCHMARK(normals)->Unit(benchmark::kMillisecond);

void sampling(benchmark::State& state)
{
  const Workbench& bench = workbench();
  for (auto _ : state)
    benchmark::DoNotOptimize(sampleScene(bench.scene.grid, bench.scene.normals, bench.model->parameters.leaf,
                                         bench.parameters.preprocessing));
  countPer(state, "sample", bench.scene.samples.size());
}
BENCHMARK(sampling)->Unit(benchmark::kMillisecond);

void curvature(benchmark::State& state)
{
  const Workbench& bench = workbench();
  SceneSamples samples = bench.scene.samples;
  const TrainingParameters& trained = bench.model->parameters;
  for (auto _ : state)
  {
    estimateGridCurvature(samples, bench.scene.grid, bench.scene.runs, bench.scene.normals, trained.curvature_measure,
                          trained.curvature_radius, OPPOSITE_WALL_ANGLE, bench.executor);
    benchmark::ClobberMemory();
  }
  countPer(state, "sample", samples.size());
}
BENCHMARK(curvature)->Unit(benchmark::kMillisecond);

void segmentation(benchmark::State& state, SegmentationMethod method)
{
  const Workbench& bench = workbench();
  SegmentationParameters parameters = bench.parameters.segmentation;
  parameters.method = method;
  for (auto _ : state)
    benchmark::DoNotOptimize(segmentScene(bench.scene.grid, parameters, &bench.bin, bench.executor));
  countPer(state, "pixel", bench.scene.grid.size());
}
BENCHMARK_CAPTURE(segmentation, depth_edges, SegmentationMethod::DepthEdges)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(segmentation, watershed, SegmentationMethod::Watershed)->Unit(benchmark::kMillisecond);

void candidates(benchmark::State& state)
{
  const Workbench& bench = workbench();
  const Segmentation segments =
      segmentScene(bench.scene.grid, bench.parameters.segmentation, &bench.bin, bench.executor);
  for (auto _ : state)
    benchmark::DoNotOptimize(selectCandidates(segments, bench.scene.grid, *bench.model, bench.parameters.segmentation));
  countPer(state, "segment", segments.segments.size());
}
BENCHMARK(candidates)->Unit(benchmark::kMillisecond);
}  // namespace
}  // namespace bin_picking::kernels
