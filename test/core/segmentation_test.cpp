// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/segmentation/segmentation.hpp"
#include "core/analytic_scenes.hpp"

using namespace bin_picking;
using namespace bin_picking::test;

namespace
{
/// A gray picture to draw into.
struct Picture
{
  int width = 120;
  int height = 100;
  std::vector<std::uint8_t> gray = std::vector<std::uint8_t>(static_cast<std::size_t>(width * height), 0);

  void disc(int u, int v, double radius, int level)
  {
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (std::hypot(x - u, y - v) <= radius)
          at(x, y) = static_cast<std::uint8_t>(level);
  }
  void box(int u, int v, int w, int h, int level)
  {
    for (int y = v; y < v + h; ++y)
      for (int x = u; x < u + w; ++x)
        at(x, y) = static_cast<std::uint8_t>(level);
  }
  std::uint8_t& at(int u, int v) { return gray[static_cast<std::size_t>(v * width + u)]; }

  std::vector<std::int32_t> segments(const SegmentationParameters& parameters = {}) const
  {
    return watershedSegments(gray, width, height, parameters);
  }
  int count(const SegmentationParameters& parameters = {}) const
  {
    const auto labels = segments(parameters);
    std::set<std::int32_t> distinct(labels.begin(), labels.end());
    distinct.erase(0);
    return static_cast<int>(distinct.size());
  }
  int labelAt(int u, int v) const { return segments()[static_cast<std::size_t>(v * width + u)]; }
};

Surface disc(const Eigen::Vector3d& centre, double radius)
{
  return plane(centre, -Eigen::Vector3d::UnitZ(),
               [=](const Eigen::Vector3d& p) { return (p - centre).head<2>().norm() <= radius; });
}

SegmentationParameters byDepthEdges()
{
  SegmentationParameters parameters;
  parameters.step = 1;
  return parameters;
}

SegmentationParameters byWatershed()
{
  SegmentationParameters parameters = byDepthEdges();
  parameters.method = SegmentationMethod::Watershed;
  return parameters;
}

/// A part that looks like a disc of 20 mm radius from every side.
TrainedModel roundModel()
{
  TrainedModel model;
  ViewTemplate view;
  view.area = static_cast<float>(PI * 0.02 * 0.02);
  view.contour = static_cast<float>(2 * PI * 0.02);
  model.views = {view, view};
  return model;
}
}  // namespace

TEST(Algorithm1, Step2WhiteIsBackground)
{
  Picture picture;
  picture.box(0, 0, picture.width, picture.height, 255);
  picture.disc(30, 50, 18, 200);
  picture.disc(85, 50, 18, 120);
  EXPECT_EQ(picture.count(), 2);
  EXPECT_EQ(picture.labelAt(60, 5), 0);
  EXPECT_NE(picture.labelAt(30, 50), picture.labelAt(85, 50));
}

TEST(Algorithm1, Steps3And4SharpeningCutsAtFaintGrooves)
{
  // A groove of one pixel in a box of level 120. Its Laplacian is 6 x depth, so that the sharpened groove has the level
  // 120 - 7 x depth: at depth 20 below t1 = 40, at depth 2 above.
  const auto segments_with_groove = [](int depth) {
    Picture picture;
    picture.box(20, 30, 81, 40, 120);
    picture.box(60, 30, 1, 40, 120 - depth);
    return picture.count();
  };
  EXPECT_EQ(segments_with_groove(20), 2);
  EXPECT_EQ(segments_with_groove(2), 1);
}

TEST(Algorithm1, Steps5And6DarkerThanT1IsIgnored)
{
  Picture picture;
  picture.disc(30, 50, 18, 60);
  picture.disc(85, 50, 18, 200);
  SegmentationParameters parameters;
  parameters.t1 = 40;
  EXPECT_EQ(picture.count(parameters), 2);
  // The Laplacian lifts the rim of a blob on black: above that level, so that only the inside tells.
  parameters.t1 = 150;
  parameters.t2 = 0.5;
  EXPECT_EQ(picture.count(parameters), 1);
}

TEST(Algorithm1, Steps7And9TheDistanceParts_WhatTouches)
{
  Picture picture;  // half the width of the neck is sqrt(18^2 - 15^2) = 9.9, 0.55 of the discs' radius
  picture.disc(40, 50, 18, 150);
  picture.disc(70, 50, 18, 150);
  SegmentationParameters parameters;
  parameters.t2 = 0.4;
  EXPECT_EQ(picture.count(parameters), 1);
  parameters.t2 = 0.7;
  EXPECT_EQ(picture.count(parameters), 2);
}

TEST(Algorithm1, Step8NormalizesByTheLargestBlob)
{
  Picture small;
  small.disc(100, 50, 9, 150);
  EXPECT_EQ(small.count(), 1);
  Picture both = small;
  both.disc(45, 50, 35, 150);  // 9 / 35 is below t2 = 0.4
  EXPECT_EQ(both.count(), 1);
  EXPECT_EQ(both.labelAt(100, 50), 0);
}

TEST(Algorithm1, Step10ErosionTakesSmallMarkersAway)
{
  Picture picture;
  picture.disc(60, 50, 10, 150);
  SegmentationParameters parameters;
  parameters.t2 = 0.8;  // the marker has a radius of 2 pixels
  parameters.erosion = 0;
  EXPECT_EQ(picture.count(parameters), 1);
  parameters.erosion = 3;
  EXPECT_EQ(picture.count(parameters), 0);
}

TEST(Algorithm1, Steps11And12MarkersGrowToTheBordersOfTheirBlobs)
{
  Picture picture;
  picture.disc(35, 50, 25, 150);
  picture.disc(88, 50, 25, 90);
  const auto labels = picture.segments();
  int inside = 0;
  for (int v = 0; v < picture.height; ++v)
    for (int u = 0; u < picture.width; ++u)
    {
      const int label = labels[static_cast<std::size_t>(v * picture.width + u)];
      EXPECT_TRUE(picture.at(u, v) > 0 || label == 0) << u << ", " << v;
      inside += label > 0;
    }
  // The markers are discs of 0.6 of the radius, less one pixel; the watershed leaves a border of about a pixel.
  EXPECT_GT(inside, 0.85 * 2 * PI * 25 * 25);
}

TEST(Algorithm1, PicturesWithoutBlobsOrWithoutBackground)
{
  EXPECT_EQ(Picture().count(), 0);
  Picture full;
  full.box(0, 0, full.width, full.height, 150);
  EXPECT_EQ(full.count(), 1);
  EXPECT_THROW(watershedSegments({1, 2, 3}, 2, 2, SegmentationParameters()), ParameterError);
}

TEST(DepthToGray, MapsTheGivenRange)
{
  DepthGrid grid = makeGrid(5, 1, testCamera());
  grid.z = {0.6f, 0.7f, 0.8f, 0.5f, std::numeric_limits<float>::quiet_NaN()};
  SegmentationParameters parameters;
  parameters.gray_near = 0.6;
  parameters.gray_far = 0.8;
  EXPECT_EQ(depthToGray(grid, parameters, nullptr), (std::vector<std::uint8_t>{255, 128, 1, 255, 0}));
  parameters.gray_near = 0.9;
  EXPECT_THROW(depthToGray(grid, parameters, nullptr), ParameterError);
  parameters.gray_near = 0.5;
  parameters.gray_far = 0;
  EXPECT_THROW(depthToGray(grid, parameters, nullptr), ParameterError);
}

TEST(DepthToGray, TakesTheRangeFromTheDataOrTheBin)
{
  // Levels from 0.6 to 0.9 m, and one stray point that must not stretch the range.
  DepthGrid grid = makeGrid(1001, 1, testCamera());
  grid.x.assign(grid.size(), 0);
  grid.y.assign(grid.size(), 0);
  for (std::size_t i = 0; i < 1000; ++i)
    grid.z[i] = 0.6f + 0.3f * static_cast<float>(i) / 999;
  grid.z[1000] = 5;
  const auto gray = depthToGray(grid, SegmentationParameters(), nullptr);
  EXPECT_NEAR(gray[500], 128, 2);
  EXPECT_EQ(gray[1000], 1);

  Bin bin;  // floor at 0.8 m, rim at 0.7 m
  bin.T_camera_bin.translation() = Eigen::Vector3d(0, 0, 0.8);
  bin.T_camera_bin.linear() = Eigen::AngleAxisd(PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
  bin.inner_size = {0.3, 0.2, 0.1};
  const auto gray_in_bin = depthToGray(grid, SegmentationParameters(), &bin);
  EXPECT_EQ(gray_in_bin[300], 255);       // 0.69 m: above the rim
  EXPECT_NEAR(gray_in_bin[500], 128, 2);  // 0.75 m: half-way
  EXPECT_EQ(gray_in_bin[700], 1);         // 0.81 m: below the floor
  EXPECT_EQ(depthToGray(makeGrid(3, 1, testCamera()), {}, nullptr), std::vector<std::uint8_t>(3, 0));
}

TEST(SegmentScene, SeparatePartsAreCountedAndMeasured)
{
  const DepthGrid grid = render({rectangle({-0.08, 0, 0.8}, 0.06, 0.04), disc({0.06, 0.02, 0.78}, 0.03)});
  for (auto parameters : {byDepthEdges(), byWatershed()})
  {
    parameters.gray_near = 0.7;  // else the lower part would be as dark as the background
    parameters.gray_far = 0.9;
    const Segmentation s = segmentScene(grid, parameters, nullptr, Executor(1));
    ASSERT_EQ(s.segments.size(), 2u);
    const auto& box = s.segments[s.segments[0].mean_depth > 0.79 ? 0 : 1];
    const auto& round = s.segments[s.segments[0].mean_depth > 0.79 ? 1 : 0];
    // Algorithm 1 gives the outermost pixel of a segment to the border: 8 % of the box's area, 4 % of its contour.
    const double share = parameters.method == SegmentationMethod::Watershed ? 0.85 : 0.97;
    EXPECT_LT(box.area, 1.03 * 0.06 * 0.04);
    EXPECT_GT(box.area, share * 0.06 * 0.04);
    EXPECT_LT(round.area, 1.03 * PI * 0.03 * 0.03);
    EXPECT_GT(round.area, share * PI * 0.03 * 0.03);
    EXPECT_NEAR(box.contour, 0.2, 0.08 * 0.2);
    EXPECT_NEAR(round.contour, 2 * PI * 0.03, 0.08 * 2 * PI * 0.03);
    EXPECT_NEAR(round.mean_depth, 0.78, 1e-4);
    for (const auto& segment : s.segments)
      EXPECT_EQ(segment.pixels, std::count(s.labels.begin(), s.labels.end(), segment.label));
  }
}

TEST(SegmentScene, APartOnTopOfAnotherIsCutAtItsDepthEdge)
{
  const DepthGrid grid = render({rectangle({0, 0, 0.8}, 0.12, 0.1), rectangle({0.01, 0, 0.785}, 0.05, 0.04)});
  const Segmentation s = segmentScene(grid, byDepthEdges(), nullptr, Executor(1));
  ASSERT_EQ(s.segments.size(), 2u);
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (s.labels[i] > 0)
    {
      EXPECT_NEAR(grid.z[i], s.segments[static_cast<std::size_t>(s.labels[i] - 1)].mean_depth, 1e-4);
    }
}

TEST(SegmentScene, CurvedAndNoisySurfacesWithHolesStayWhole)
{
  DepthGrid grid = render({cylinder({0, 0, 0.8}, {1, 0.3, 0.1}, 0.016, 0.1)});
  addDepthNoise(grid, 0.0005, 5);
  std::mt19937 generator(3);
  for (int k = 0; k < 100; ++k)
    grid.invalidate(grid.index(120 + static_cast<int>(generator() % 80), 110 + static_cast<int>(generator() % 35)));
  const Segmentation s = segmentScene(grid, byDepthEdges(), nullptr, Executor(1));
  ASSERT_FALSE(s.segments.empty());
  int largest = 0;
  for (const auto& segment : s.segments)
    largest = std::max(largest, segment.pixels);
  EXPECT_GT(largest, 0.97 * numValid(grid));
}

TEST(SegmentScene, NarrowPassagesAreCutAndWideOnesAreNot)
{
  // Two plates in one plane, joined by a bridge of a third of their width.
  const DepthGrid grid = render({rectangle({-0.04, 0, 0.8}, 0.05, 0.05), rectangle({0.04, 0, 0.8}, 0.05, 0.05),
                                 rectangle({0, 0, 0.8}, 0.04, 0.016)});
  SegmentationParameters parameters = byDepthEdges();
  EXPECT_EQ(segmentScene(grid, parameters, nullptr, Executor(1)).segments.size(), 2u);
  parameters.neck = 0.2;
  EXPECT_EQ(segmentScene(grid, parameters, nullptr, Executor(1)).segments.size(), 1u);
}

TEST(SegmentScene, AThinnedGridHasTheSameSegments)
{
  const DepthGrid grid = render({rectangle({-0.08, 0, 0.8}, 0.06, 0.04), disc({0.06, 0.02, 0.78}, 0.03)});
  const Segmentation whole = segmentScene(grid, byDepthEdges(), nullptr, Executor(1));
  for (const int step : {2, 3})
  {
    SegmentationParameters parameters = byDepthEdges();
    parameters.step = step;
    const Segmentation s = segmentScene(grid, parameters, nullptr, Executor(1));
    EXPECT_EQ(s.width, (grid.width + step - 1) / step);
    EXPECT_EQ(s.labels.size(), static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height));
    ASSERT_EQ(s.segments.size(), whole.segments.size());
    for (std::size_t k = 0; k < s.segments.size(); ++k)
    {
      // Each side may lie anywhere between two pixels of the thinned grid.
      const double border = whole.segments[k].contour * step * grid.pitch(whole.segments[k].mean_depth) / 2;
      EXPECT_NEAR(s.segments[k].area, whole.segments[k].area, border);
      EXPECT_NEAR(s.segments[k].contour, whole.segments[k].contour, 0.05 * whole.segments[k].contour);
      EXPECT_NEAR(s.segments[k].mean_depth, whole.segments[k].mean_depth, 1e-4);
    }
    int differ = 0;
    for (int v = 0; v < grid.height; ++v)
      for (int u = 0; u < grid.width; ++u)
        differ += s.labelAt(u, v) != whole.labelAt(u, v);
    EXPECT_LT(differ, 0.1 * numValid(grid));  // at the borders
  }
}

TEST(SegmentScene, WithoutAMethodAllIsOneSegment)
{
  const DepthGrid grid = render({rectangle({-0.08, 0, 0.8}, 0.06, 0.04), disc({0.06, 0.02, 0.78}, 0.03)});
  SegmentationParameters parameters = byDepthEdges();
  parameters.method = SegmentationMethod::None;
  const Segmentation s = segmentScene(grid, parameters, nullptr, Executor(1));
  ASSERT_EQ(s.segments.size(), 1u);
  EXPECT_EQ(s.segments[0].pixels, numValid(grid));
}

TEST(SegmentScene, NothingGivesNoSegments)
{
  for (const auto method : {SegmentationMethod::None, SegmentationMethod::Watershed, SegmentationMethod::DepthEdges})
  {
    SegmentationParameters parameters;
    parameters.method = method;
    EXPECT_TRUE(segmentScene(makeGrid(40, 30, testCamera()), parameters, nullptr, Executor(1)).segments.empty());
    EXPECT_TRUE(segmentScene(makeGrid(0, 0, testCamera()), parameters, nullptr, Executor(1)).segments.empty());
  }
}

TEST(SelectCandidates, WholeViewsAreAcceptedHalfOnesAndPairsAreNot)
{
  const Eigen::Vector3d cut(-0.03, -0.05, 0.8);
  const DepthGrid grid =
      render({disc({-0.1, 0.04, 0.8}, 0.02),
              plane(cut, -Eigen::Vector3d::UnitZ(),
                    [=](const Eigen::Vector3d& p) { return (p - cut).head<2>().norm() <= 0.02 && p.x() < cut.x(); }),
              disc({0.04, 0.04, 0.8}, 0.02), disc({0.07, 0.04, 0.8}, 0.02), disc({0.1, -0.08, 0.8}, 0.002)});
  SegmentationParameters parameters = byDepthEdges();
  parameters.neck = 0.3;  // so that the touching pair is one segment
  const Segmentation s = segmentScene(grid, parameters, nullptr, Executor(1));
  ASSERT_EQ(s.segments.size(), 4u);
  const int whole = s.labels[static_cast<std::size_t>(grid.index(60, 167))];
  const auto candidates = selectCandidates(s, grid, roundModel(), parameters);
  ASSERT_EQ(candidates.size(), 1u);
  EXPECT_EQ(candidates[0].label, whole);
  EXPECT_NEAR(candidates[0].pixel_ratio, 1, 0.03);
  EXPECT_NEAR(candidates[0].contour_ratio, 1, 0.05);

  const auto all = selectCandidates(s, grid, roundModel(), parameters, true);
  ASSERT_EQ(all.size(), 3u);  // the speck is below min_segment_area
  EXPECT_EQ(all[0].label, whole);
  const auto [half, pair] = std::minmax(all[1].pixel_ratio, all[2].pixel_ratio);
  EXPECT_NEAR(half, 0.5, 0.05);
  EXPECT_GT(pair, 1.7);
}

TEST(SelectCandidates, ViewsAreScaledToTheDepthAndHigherPartsComeFirst)
{
  const DepthGrid grid = render({disc({-0.05, 0, 0.95}, 0.02), disc({0.05, 0, 0.6}, 0.02)});
  for (const int step : {1, 2})
  {
    SegmentationParameters parameters = byDepthEdges();
    parameters.step = step;
    const Segmentation s = segmentScene(grid, parameters, nullptr, Executor(1));
    const auto candidates = selectCandidates(s, grid, roundModel(), parameters);
    ASSERT_EQ(candidates.size(), 2u);
    for (const auto& candidate : candidates)
      EXPECT_NEAR(candidate.pixel_ratio, 1, 0.04 * step);
    EXPECT_NEAR(s.segments[static_cast<std::size_t>(candidates[0].label - 1)].mean_depth, 0.6, 0.01);
    EXPECT_GT(candidates[0].priority, candidates[1].priority);
  }
}

TEST(SelectCandidates, TheBestFittingViewDecides)
{
  const DepthGrid grid = render({rectangle({0, 0, 0.8}, 0.08, 0.02)});
  const Segmentation s = segmentScene(grid, byDepthEdges(), nullptr, Executor(1));
  TrainedModel model = roundModel();
  SegmentationParameters loose = byDepthEdges();
  loose.max_contour_ratio = 1.8;
  EXPECT_EQ(selectCandidates(s, grid, model, loose).size(), 1u);  // 1.3 times the area, 1.6 times the contour
  SegmentationParameters strict = byDepthEdges();
  strict.max_contour_ratio = 1.3;
  EXPECT_TRUE(selectCandidates(s, grid, model, strict).empty());
  model.views[1].area = 0.08f * 0.02f;
  model.views[1].contour = 0.2f;
  EXPECT_EQ(selectCandidates(s, grid, model, strict).size(), 1u);
}

TEST(SegmentationParameters, DefaultsAreWithinTheirRanges)
{
  SegmentationParameters parameters;
  for (const auto& entry : listParameters(visitor(parameters)))
    EXPECT_NO_THROW(setParameter(visitor(parameters), entry.path, entry.value)) << entry.path;
}
