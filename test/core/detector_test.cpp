// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/detector.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/evaluation/pose_error.hpp"
#include "tee_scene.hpp"

namespace bin_picking
{
namespace
{
constexpr double SIGMA = 0.0001;

Detector detector(DetectorParameters parameters = {}) { return Detector({test::teeModel()}, std::move(parameters)); }

/// Index of the detection that is the instance at `truth`; -1 if none.
int indexOf(const std::vector<Detection>& detections, const Pose& truth)
{
  for (std::size_t i = 0; i < detections.size(); ++i)
  {
    const PoseError error =
        poseError(detections[i].T_camera_object, truth, test::teeModel()->symmetry, test::teeModel()->center);
    if (error.translation < 0.001 && error.rotation < 0.02)
      return static_cast<int>(i);
  }
  return -1;
}

std::string nearestError(const std::vector<Detection>& detections, const Pose& truth)
{
  PoseError best{1e9, 0};
  for (const auto& d : detections)
  {
    const PoseError error = poseError(d.T_camera_object, truth, test::teeModel()->symmetry, test::teeModel()->center);
    if (error.translation < best.translation)
      best = error;
  }
  return "the nearest is off by " + std::to_string(1e3 * best.translation) + " mm and " +
         std::to_string(best.rotation) + " rad";
}

TEST(Detector, findsEveryFreePartAndNothingElse)
{
  for (const std::uint32_t seed : {1u, 2u, 3u})
  {
    const auto truth = test::posesApart(4, seed);
    Detector::Request request;
    request.bin = test::wideBin();
    const DetectionResult result = detector().detect(test::renderTees(truth, SIGMA), request);
    EXPECT_EQ(result.code, DetectionCode::Ok) << result.message;
    EXPECT_EQ(result.detections.size(), truth.size()) << "seed " << seed;
    for (const auto& T : truth)
      EXPECT_GE(indexOf(result.detections, T), 0) << "seed " << seed << " " << nearestError(result.detections, T);
    for (std::size_t i = 0; i < result.detections.size(); ++i)
    {
      const Detection& d = result.detections[i];
      EXPECT_NEAR(
          (d.T_camera_object.linear() * d.T_camera_object.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 0,
          1e-9);
      EXPECT_NEAR(d.T_camera_object.linear().determinant(), 1, 1e-9);
      EXPECT_TRUE(d.rejection.empty());
      for (const auto& criterion : d.criteria)
        EXPECT_TRUE(criterion.passed()) << criterion.name;
      EXPECT_GT(d.matching_rate, 0.95);
      if (i > 0)
      {
        EXPECT_LE(d.score, result.detections[i - 1].score);
      }
    }
    for (const auto& rejected : result.rejected)
      EXPECT_FALSE(rejected.rejection.empty());
  }
}

double countOf(const DetectionResult& result, const std::string& stage)
{
  const auto entry = std::find_if(result.counts.begin(), result.counts.end(),
                                  [&](const StageCount& count) { return count.stage == stage; });
  return entry == result.counts.end() ? 0 : entry->count;
}

TEST(Detector, whatAGlanceAtTheClustersContradictsLeastIsRight)
{
  DetectorParameters parameters;
  parameters.clustering.promising_share = 0.01;
  const auto truth = test::posesApart(4, 1);
  const DetectionResult result = detector(parameters).detect(test::renderTees(truth, SIGMA), {});
  const double kept = std::ceil(0.01 * countOf(result, "clusters"));
  EXPECT_LE(countOf(result, "refined"), kept);
  EXPECT_GT(countOf(result, "clusters"), 20 * kept);  // or little was dropped
  ASSERT_FALSE(result.detections.empty()) << result.message;
  EXPECT_TRUE(
      std::any_of(truth.begin(), truth.end(), [&](const Pose& T) { return indexOf(result.detections, T) == 0; }));
}

/// Poses of one part that near symmetries lead to from each other end, settled among their rivals, at the same one: it
/// is refined once, and not once for each of them.
TEST(Detector, rivalsOfOnePlaceAreNotRefinedToTheSameEnd)
{
  for (const std::uint32_t seed : {1u, 2u, 3u})
  {
    const auto truth = test::posesApart(4, seed);
    const DetectionResult result = detector().detect(test::renderTees(truth, SIGMA), {});
    for (const auto& T : truth)
    {
      EXPECT_GE(indexOf(result.detections, T), 0) << "seed " << seed;
      EXPECT_EQ(indexOf(result.rejected, T), -1) << "seed " << seed << ": refined twice";
    }
  }
}

TEST(Detector, sameBitsForAnyNumberOfThreadsAndTwoRuns)
{
  const DepthGrid grid = test::renderTees(test::posesApart(4, 5), SIGMA);
  DetectorParameters one;
  one.num_threads = 1;
  DetectorParameters two;
  two.num_threads = 2;
  const auto a = detector(one).detect(grid, {});
  for (const auto& b : {detector(two).detect(grid, {}), detector(two).detect(grid, {})})
  {
    ASSERT_EQ(a.detections.size(), b.detections.size());
    ASSERT_EQ(a.rejected.size(), b.rejected.size());
    for (std::size_t i = 0; i < a.detections.size(); ++i)
    {
      EXPECT_TRUE(a.detections[i].T_camera_object.matrix() == b.detections[i].T_camera_object.matrix());
      EXPECT_EQ(a.detections[i].score, b.detections[i].score);
      EXPECT_EQ(a.detections[i].matching_rate, b.detections[i].matching_rate);
    }
  }
}

TEST(Detector, paperPresetFindsItsCandidateTargets)
{
  // Upright tees, as segmentation by Algorithm 1 wants them: whole and apart.
  const auto truth = test::posesApart(4, 3);
  Detector::Request request;
  request.bin = test::wideBin();
  request.keep_segmentation = true;
  // The preset looks up cut-off neighbourhoods as any other, so the model has its curvature all around, as in the text.
  TrainingParameters training;
  training.feature = FeatureKind::CurPpf;
  training.curvature_in_views = false;
  const auto model = trainPart(test::teeDefinition(), training, Executor(2));
  const DetectionResult result =
      Detector({model}, DetectorParameters::preset("paper")).detect(test::renderTees(truth, SIGMA), request);
  ASSERT_GE(result.detections.size(), 2u) << result.message;
  const auto right =
      std::count_if(truth.begin(), truth.end(), [&](const Pose& T) { return indexOf(result.detections, T) >= 0; });
  EXPECT_GE(right, 2);
  EXPECT_TRUE(std::any_of(truth.begin(), truth.end(), [&](const Pose& T) {
    return indexOf(result.detections, T) == 0;
  })) << "the best-ranked detection is not right";
  ASSERT_TRUE(result.segmentation);
  EXPECT_GT(*std::max_element(result.segmentation->labels.begin(), result.segmentation->labels.end()), 1);
  EXPECT_EQ(result.segmentation->gray.size(), result.segmentation->labels.size());
}

TEST(Detector, everyFeatureFindsTheParts)
{
  const auto truth = test::posesApart(3, 7);
  const DepthGrid grid = test::renderTees(truth, SIGMA);
  for (const FeatureKind feature : {FeatureKind::Ppf, FeatureKind::CurPpfUnweighted})
  {
    TrainingParameters training;
    training.feature = feature;
    const auto model = trainPart(test::teeDefinition(), training, Executor(2));
    const auto result = Detector({model}, {}).detect(grid, {});
    for (const auto& T : truth)
      EXPECT_GE(indexOf(result.detections, T), 0) << nearestError(result.detections, T);
  }
}

TEST(Detector, emptyBinIsAnOrdinaryResultThatSaysSo)
{
  Detector::Request request;
  request.bin = test::wideBin();
  const DetectionResult result = detector().detect(test::renderTees({}, SIGMA), request);
  EXPECT_EQ(result.code, DetectionCode::BinEmpty);
  EXPECT_TRUE(result.detections.empty());
  EXPECT_NE(result.message.find("empty"), std::string::npos);
  ASSERT_TRUE(result.surroundings);
  const auto measured = [](float z) { return !std::isnan(z); };
  EXPECT_GT(std::count_if(result.surroundings->z.begin(), result.surroundings->z.end(), measured), 1000) << "the floor";
}

/// Nothing above the floor, and no measurement where `lost` says so.
DepthGrid emptyScene(const std::function<bool(int u, int v)>& lost)
{
  DepthGrid grid = test::renderTees({}, SIGMA);
  for (int v = 0; v < grid.height; ++v)
    for (int u = 0; u < grid.width; ++u)
      if (lost(u, v))
        grid.invalidate(grid.index(u, v));
  return grid;
}

TEST(Detector, aBinOfWhichLittleIsMeasuredIsNotCalledEmpty)
{
  Detector::Request request;
  request.bin = test::wideBin();
  const auto result = [&](const std::function<bool(int u, int v)>& lost) {
    return detector().detect(emptyScene(lost), request);
  };
  // The picture is 480 pixels wide, the bin's floor nearly as wide.
  EXPECT_EQ(result([](int u, int) { return u < 200; }).code, DetectionCode::BinEmpty);
  const DetectionResult covered = result([](int u, int) { return u < 280; });
  EXPECT_EQ(covered.code, DetectionCode::BinUnseen) << covered.message;
  EXPECT_NE(covered.message.find("of its floor is measured"), std::string::npos) << covered.message;
  EXPECT_NE(covered.message.find("empty_bin_floor_share"), std::string::npos) << covered.message;
  // The projector is off: only what is bright without it, beside the bin, is measured; or nothing at all.
  EXPECT_EQ(result([](int u, int v) { return u > 5 || v > 5; }).code, DetectionCode::BinUnseen);
  EXPECT_EQ(result([](int, int) { return true; }).code, DetectionCode::BinUnseen);
  // Something else is measured where the floor should be: the bin is not there, or its pose is wrong.
  request.bin->T_camera_bin.translation().z() -= 0.03;
  EXPECT_EQ(result([](int, int) { return false; }).code, DetectionCode::BinUnseen);
}

TEST(Detector, withoutABinThePictureTellsWhetherAnythingWasSeen)
{
  DetectorParameters parameters;
  parameters.input.z_max = 0.65;  // above the floor
  const auto code = [&](const std::function<bool(int u, int v)>& lost) {
    return detector(parameters).detect(emptyScene(lost), {}).code;
  };
  EXPECT_EQ(code([](int, int) { return false; }), DetectionCode::BinEmpty);
  EXPECT_EQ(code([](int u, int) { return u > 20; }), DetectionCode::BinUnseen);
}

/// A ball, which is no part, over the floor.
DepthGrid ballScene(const Eigen::Vector3d& middle)
{
  DepthRenderer renderer(480, 384, test::smallCamera());
  renderer.draw(test::floorMesh(), Pose::Identity(), 0);
  Pose T = Pose::Identity();
  T.translation() = middle;
  renderer.draw(test::sphere(0.05, 60000), T, 0.002, 1);
  return renderer.grid();
}

TEST(Detector, whatLiesBesideTheWallsIsSearchedButDoesNotFillTheBin)
{
  const auto truth = test::posesApart(1, 1);
  Detector::Request request;
  request.bin = test::wideBin();
  DetectorParameters parameters;
  parameters.input.empty_bin_wall_margin = 0.149;  // nearly all of the bin is beside a wall
  const DetectionResult found = detector(parameters).detect(test::renderTees(truth, SIGMA), request);
  EXPECT_EQ(found.code, DetectionCode::Ok) << found.message;
  EXPECT_GE(indexOf(found.detections, truth[0]), 0) << nearestError(found.detections, truth[0]);

  const DepthGrid ball = ballScene({0, 0.07, 0.6});
  const DetectionResult nothing = detector(parameters).detect(ball, request);
  EXPECT_EQ(nothing.code, DetectionCode::BinEmpty) << nothing.message;
  EXPECT_FALSE(nothing.rejected.empty()) << "it was searched";
  EXPECT_NE(nothing.message.find("149.0 mm off its walls"), std::string::npos) << nothing.message;
  parameters.input.empty_bin_wall_margin = 0.006;
  EXPECT_EQ(detector(parameters).detect(ball, request).code, DetectionCode::NoMatch);
}

TEST(Detector, aSceneThatIsEmptyForOnePartDoesNotLoseTheOther)
{
  TrainingParameters coarse;
  coarse.leaf = 0.012;
  PartDefinition definition = test::teeDefinition();
  definition.name = "coarse_tee";
  const auto coarse_model = trainPart(definition, coarse, Executor(2));
  const auto truth = test::posesApart(2, 1);
  const DepthGrid grid = test::renderTees(truth, SIGMA);
  Detector::Request request;
  request.bin = test::wideBin();
  const auto points = [&](const std::shared_ptr<const TrainedModel>& model) {
    const auto counts = Detector({model}, {}).detect(grid, request).counts;
    return std::find_if(counts.begin(), counts.end(), [](const StageCount& c) { return c.stage == "points"; })->count;
  };
  const double fine = points(test::teeModel());
  const double rough = points(coarse_model);
  ASSERT_NE(fine, rough);
  // The limit lies between: the scene is empty at one leaf and not at the other.
  DetectorParameters parameters;
  parameters.input.empty_bin_points = static_cast<int>((fine + rough) / 2);
  const auto alone = Detector({fine > rough ? test::teeModel() : coarse_model}, parameters).detect(grid, request);
  ASSERT_NE(alone.code, DetectionCode::BinEmpty);
  for (const bool coarse_first : {true, false})
  {
    std::vector<std::shared_ptr<const TrainedModel>> models = {test::teeModel(), coarse_model};
    if (coarse_first)
      std::swap(models[0], models[1]);
    const auto both = Detector(models, parameters).detect(grid, request);
    EXPECT_EQ(both.code, alone.code) << both.message;
    EXPECT_EQ(both.detections.size(), alone.detections.size());
    EXPECT_EQ(both.surroundings->size(),
              Detector({test::teeModel()}, parameters).detect(grid, request).surroundings->size())
        << "the finer of the two";
  }
}

TEST(Detector, otherThingsAreNoMatchWithReasons)
{
  const DetectionResult result = detector().detect(ballScene({0, 0, 0.6}), {});
  EXPECT_EQ(result.code, DetectionCode::NoMatch);
  EXPECT_TRUE(result.detections.empty());
  EXPECT_FALSE(result.message.empty());
}

TEST(Detector, unknownPartNamesTheNearOne)
{
  Detector::Request request;
  request.parts = {"three_way_tub"};
  try
  {
    detector().detect(test::renderTees({}, SIGMA), request);
    FAIL() << "no error";
  }
  catch (const ParameterError& error)
  {
    EXPECT_NE(std::string(error.what()).find("did you mean 'three_way_tube'"), std::string::npos) << error.what();
  }
}

TEST(Detector, passedDeadlineIsPartial)
{
  Detector::Request request;
  request.deadline = 1e-9;
  const DetectionResult result = detector().detect(test::renderTees(test::posesApart(2, 1), SIGMA), request);
  EXPECT_TRUE(result.partial);
  EXPECT_TRUE(result.detections.empty());
  EXPECT_NE(result.message.find("deadline"), std::string::npos);
}

TEST(Detector, refusesNoModelsAndParametersOutOfRange)
{
  EXPECT_THROW(Detector({}, {}), ParameterError);
  DetectorParameters parameters;
  parameters.voting.weight = 0;
  EXPECT_THROW(detector(parameters), ParameterError);
  EXPECT_THROW(DetectorParameters::preset("fats"), ParameterError);
}

TEST(Detector, everyPresetLiesWithinItsRanges)
{
  for (const char* name : {"paper", "fast", "accurate"})
    EXPECT_NO_THROW(detector(DetectorParameters::preset(name))) << name;
}

TEST(Match, findsThePartInAWholeScan)
{
  std::mt19937 random(3);
  const Pose truth = test::randomPose(random, 0.3);
  const OrientedPoints scan = transformed(sampleSurface(test::teeModel()->mesh, 0.001, 77), truth);
  const DetectionResult result = detector(DetectorParameters::preset("paper")).match(scan, true);
  ASSERT_FALSE(result.detections.empty());
  EXPECT_EQ(indexOf({result.detections.front()}, truth), 0);
  EXPECT_GT(result.detections.front().matching_rate, 0.999);
  EXPECT_THROW(detector().match({}, true), CloudError);
}

/// What a camera at the origin might see of the part: all that faces it, noisy along the ray.
OrientedPoints facingScan(const Pose& truth, std::uint32_t seed)
{
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0, static_cast<float>(SIGMA));
  const OrientedPoints all = transformed(sampleSurface(test::teeModel()->mesh, 0.001, seed), truth);
  OrientedPoints scan;
  for (std::size_t i = 0; i < all.size(); ++i)
  {
    const Eigen::Vector3f ray = all.points[i].normalized();
    if (all.normals[i].dot(ray) > -0.2f)
      continue;
    scan.points.emplace_back(all.points[i] + noise(random) * ray);
    scan.normals.push_back(all.normals[i]);
  }
  return scan;
}

TEST(Match, fitsTheDistanceFieldFarBelowTheSpacingOfThePoints)
{
  const auto errorOf = [](IcpMethod method, std::uint32_t seed) {
    std::mt19937 random(seed);
    Pose truth = test::randomPose(random, 0.1);
    truth.translation().z() += 0.6;
    DetectorParameters parameters;
    parameters.icp.method = method;
    const DetectionResult result = detector(parameters).match(facingScan(truth, seed), false);
    if (result.detections.empty())
      return PoseError{1, 1};
    return poseError(result.detections.front().T_camera_object, truth, test::teeModel()->symmetry,
                     test::teeModel()->center);
  };
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u})
  {
    const PoseError fitted = errorOf(IcpMethod::DistanceField, seed);
    // A thousand points with 0.1 mm of noise; the field itself is exact to a quarter of its cell.
    EXPECT_LT(fitted.translation, 0.0001) << "seed " << seed;
    EXPECT_LT(fitted.rotation, 0.004) << "seed " << seed;
    EXPECT_LT(fitted.translation, 0.5 * errorOf(IcpMethod::None, seed).translation) << "seed " << seed;
    EXPECT_LT(fitted.translation, errorOf(IcpMethod::PointToPoint, seed).translation) << "seed " << seed;
  }
}

TEST(Match, returnsEachPlaceOnce)
{
  const TrainedModel& tee = *test::teeModel();
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u, 5u, 6u})
  {
    std::mt19937 random(seed);
    Pose truth = test::randomPose(random, 0.1);
    truth.translation().z() += 0.6;
    DetectorParameters parameters;
    parameters.verification.min_matching_rate = 0;
    const std::vector<Detection> found = detector(parameters).match(facingScan(truth, seed), false).detections;
    EXPECT_EQ(indexOf(found, truth), 0) << "seed " << seed;
    for (std::size_t i = 0; i < found.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
      {
        const PoseError between =
            poseError(found[i].T_camera_object, found[j].T_camera_object, tee.symmetry, tee.center);
        EXPECT_TRUE(between.translation > 0.05 * tee.diameter || between.rotation > 0.2) << i << " and " << j;
      }
  }
}

TEST(Match, residualsDecideWhereTheMatchingRateIsBlind)
{
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u, 5u, 6u})
  {
    std::mt19937 random(seed);
    Pose truth = test::randomPose(random, 0.1);
    truth.translation().z() += 0.6;
    DetectorParameters parameters;
    parameters.verification.match_distance = 0.1;  // wider than the part: at any pose it matches
    const DetectionResult result = detector(parameters).match(facingScan(truth, seed), false);
    ASSERT_GT(result.detections.size(), 1u);
    EXPECT_EQ(result.detections.front().matching_rate, result.detections.back().matching_rate);
    EXPECT_EQ(indexOf(result.detections, truth), 0) << "seed " << seed;
  }
}

TEST(Match, endsWherePosesAgreeButForThePaper)
{
  std::mt19937 random(3);
  const OrientedPoints scan =
      transformed(sampleSurface(test::teeModel()->mesh, 0.001, 77), test::randomPose(random, 0.3));
  const auto refined = [&](DetectorParameters parameters, bool verify) {
    parameters.verification.enabled = verify;
    const DetectionResult result = detector(parameters).match(scan, true);
    const auto count = std::find_if(result.counts.begin(), result.counts.end(),
                                    [](const StageCount& one) { return one.stage == "refined"; });
    return count == result.counts.end() ? 0 : count->count;
  };
  const DetectorParameters parameters = DetectorParameters::preset("paper");
  EXPECT_GE(refined(parameters, true), 4);
  EXPECT_LT(refined(parameters, true), 10);
  EXPECT_EQ(refined(parameters, false), 10);
}

TEST(Match, refusesPointsThatAreNone)
{
  const auto complaint = [](const OrientedPoints& points) -> std::string {
    try
    {
      detector().match(points, true);
    }
    catch (const ParameterError& error)
    {
      return error.what();
    }
    return "";
  };
  OrientedPoints points = test::sphere(0.05, 200);
  points.points[17].y() = NAN;
  EXPECT_NE(complaint(points).find("point 17 "), std::string::npos) << complaint(points);
  points = test::sphere(0.05, 200);
  points.normals.pop_back();
  EXPECT_NE(complaint(points).find("199 normals"), std::string::npos) << complaint(points);
}

TEST(Match, saysWhyNothingWasFoundAndThatTimeWasUp)
{
  const OrientedPoints ball = test::sphere(0.05, 20000);
  DetectorParameters parameters = DetectorParameters::preset("paper");
  parameters.verification.min_matching_rate = 1;
  const DetectionResult other = detector(parameters).match(ball, true);
  EXPECT_EQ(other.code, DetectionCode::NoMatch);
  EXPECT_NE(other.message.find("matching_rate is"), std::string::npos) << other.message;
  parameters.deadline = 1e-9;
  const DetectionResult late = detector(parameters).match(ball, true);
  EXPECT_TRUE(late.partial);
  EXPECT_NE(late.message.find("deadline"), std::string::npos) << late.message;
}
}  // namespace
}  // namespace bin_picking
