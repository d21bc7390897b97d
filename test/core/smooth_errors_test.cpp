// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "bin_picking_perception/refinement/icp.hpp"
#include "bin_picking_perception/scene/grid_connectivity.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "tee_scene.hpp"

namespace bin_picking
{
namespace
{
constexpr double ERROR_LENGTH = 8;  // pixels after which the errors are alike by 1/e
constexpr double ERROR = 0.0005;    // metres, standard deviation
const double SPACING = 6 / test::smallCamera().fx;

/// Smooth noise of standard deviation 1: waves of random directions whose lengths make the autocorrelation
/// exp(-(distance / ERROR_LENGTH)^2) (Rahimi and Recht 2007). No interpolation between nodes.
class SmoothNoise
{
public:
  explicit SmoothNoise(std::uint32_t seed)
  {
    std::mt19937 random(seed);
    std::normal_distribution<double> frequency(0, std::sqrt(2.0) / ERROR_LENGTH);
    std::uniform_real_distribution<double> phase(0, 2 * M_PI);
    for (auto& wave : waves_)
      wave = {frequency(random), frequency(random), phase(random)};
  }

  double at(int u, int v) const
  {
    double sum = 0;
    for (const auto& wave : waves_)
      sum += std::cos(wave[0] * u + wave[1] * v + wave[2]);
    return sum * std::sqrt(2.0 / static_cast<double>(waves_.size()));
  }

private:
  std::array<std::array<double, 3>, 60> waves_;
};

/// Tees above a floor, measured with independent errors of 0.02 mm and smooth ones.
struct TeeScene
{
  TeeScene(const std::vector<Pose>& poses, const SmoothNoise& noise, double error = ERROR)
      : grid(test::renderTees(poses, 0.00002))
  {
    for (int v = 0; v < grid.height; ++v)
      for (int u = 0; u < grid.width; ++u)
        disturb(grid.index(u, v), error * noise.at(u, v));
    const Executor executor(1);
    const ConnectedRuns runs = connectedRuns(grid, EdgeRule(), executor);
    normals = estimateGridNormals(grid, runs, test::teeModel()->parameters.normal_radius, executor);
    edges = findDepthEdges(grid, grid, runs, test::teeModel()->parameters.leaf / 2, executor);
  }

  Pose leastSquares(const Pose& start) const
  {
    const MeasuredPart measured = measuredNear(*test::teeModel(), start, grid, normals, edges, grid.size());
    return icpDistanceField(*test::teeModel(), measured, start, {}).T_camera_object;
  }

  Pose fit(const Pose& refined) const
  {
    const OrientedPoints surface = surfaceNear(*test::teeModel(), refined, grid, normals);
    return fitBesideSmoothErrors(*test::teeModel(), surface, refined, SPACING, {});
  }

  DepthGrid grid;
  std::vector<Eigen::Vector3f> normals;
  DepthEdges edges;

private:
  void disturb(int i, double error)
  {
    const auto k = static_cast<std::size_t>(i);
    const auto scale = static_cast<float>(1 + error / static_cast<double>(grid.z[k]));
    grid.x[k] *= scale;
    grid.y[k] *= scale;
    grid.z[k] *= scale;
  }
};

double centerError(const Pose& T, const Pose& truth)
{
  return (T * test::teeModel()->center - truth * test::teeModel()->center).norm();
}

double median(std::vector<double> values)
{
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

TEST(FitBesideSmoothErrors, ErrsLessThanLeastSquaresWhereErrorsAreAlikeOverManyPixels)
{
  std::vector<double> before_center, after_center, before_turn, after_turn;
  for (std::uint32_t seed = 1; seed <= 6; ++seed)
  {
    const std::vector<Pose> poses = test::posesApart(4, seed);
    const TeeScene scene(poses, SmoothNoise(seed));
    for (const Pose& truth : poses)
    {
      const Pose before = scene.leastSquares(truth);
      const Pose after = scene.fit(before);
      before_center.push_back(centerError(before, truth));
      after_center.push_back(centerError(after, truth));
      before_turn.push_back(test::rotationError(before, truth));
      after_turn.push_back(test::rotationError(after, truth));
      EXPECT_NEAR(after.linear().determinant(), 1, 1e-12);
    }
  }
  // 24 poses: the medians are known to about a quarter. The best linear estimate, which knows the covariance of the
  // errors, errs half as much as least squares.
  EXPECT_LT(median(after_center), 0.9 * median(before_center));
  EXPECT_LT(median(after_turn), 0.8 * median(before_turn));
}

TEST(FitBesideSmoothErrors, KeepsWhatIsRight)
{
  const std::vector<Pose> poses = test::posesApart(4, 3);
  const TeeScene scene(poses, SmoothNoise(3), 0);
  for (const Pose& truth : poses)
  {
    // The distance field rounds by some hundredths of a millimetre, over levers of 20 to 40 mm.
    const Pose after = scene.fit(scene.leastSquares(truth));
    EXPECT_LT(centerError(after, truth), 0.00006);
    EXPECT_LT(test::rotationError(after, truth), 0.0025);
  }
}

TEST(FitBesideSmoothErrors, AStepThatIsTooLongIsNotTaken)
{
  const std::vector<Pose> poses = test::posesApart(1, 5);
  const TeeScene scene(poses, SmoothNoise(5));
  Pose astray = poses[0];
  astray.linear() = astray.linear() * Eigen::AngleAxisd(0.06, Eigen::Vector3d::UnitY()).toRotationMatrix();
  EXPECT_TRUE(scene.fit(astray).matrix() == astray.matrix());
}

TEST(FitBesideSmoothErrors, WithFewerPointsThanNodesThePoseStays)
{
  const Pose pose = test::posesApart(1, 5)[0];
  const TeeScene scene({pose}, SmoothNoise(5));
  const OrientedPoints surface = surfaceNear(*test::teeModel(), pose, scene.grid, scene.normals);
  const auto fit = [&](const OrientedPoints& points, double spacing) {
    return fitBesideSmoothErrors(*test::teeModel(), points, pose, spacing, {});
  };
  EXPECT_TRUE(fit({}, SPACING).matrix() == pose.matrix());
  EXPECT_TRUE(fit(surface, SPACING / 6).matrix() == pose.matrix()) << "a node per pixel";
  EXPECT_TRUE(fit(surface, 1e-30).matrix() == pose.matrix());
  EXPECT_FALSE(fit(surface, SPACING).matrix() == pose.matrix()) << "the others would not test it";
}
}  // namespace
}  // namespace bin_picking
