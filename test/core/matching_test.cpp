// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/matching/clustering.hpp"
#include "bin_picking_perception/matching/voting.hpp"
#include "bin_picking_perception/refinement/icp.hpp"
#include "bin_picking_perception/refinement/verification.hpp"
#include "hand_made_model.hpp"

namespace bin_picking
{
namespace
{
constexpr double LEAF = 0.004;

OrientedPoints sceneOf(const TrainedModel& model, const OrientedPoints& surface, const Pose& T)
{
  const TrainingParameters& p = model.parameters;
  return resampleSurface(transformed(surface, T), {p.leaf, p.normal_radius, p.curvature_measure, p.curvature_radius},
                         Executor(1));
}

class AnyFeature : public testing::TestWithParam<FeatureKind>
{
};

TEST_P(AnyFeature, recoversAnyRotationAndAnyTranslation)
{
  const TrainedModel model = test::modelOf(test::lBlock(0.001, 1), LEAF, GetParam());
  const OrientedPoints other_sampling = test::lBlock(0.001, 2);
  std::mt19937 random(11);
  for (int trial = 0; trial < 8; ++trial)
  {
    const Pose T = test::randomPose(random, 0.6);
    const OrientedPoints scene = sceneOf(model, other_sampling, T);
    VotingParameters voting;
    voting.reference_share = 0.2;
    const auto references = chooseReferences(test::everyIndex(scene.size()), voting);
    const auto votes = voteForPoses(model, scene, {}, {}, references, voting, Deadline(), Executor(2));
    const auto clusters = clusterPoses(votes.hypotheses, model, {});
    ASSERT_FALSE(clusters.empty());
    const Pose& found = clusters.front().T_camera_object;
    // Votes know alpha to a step of 12 degrees and points to a leaf; the mean of the cluster is better than either.
    EXPECT_LT((found * model.center - T * model.center).norm(), LEAF) << "trial " << trial;
    EXPECT_LT(test::rotationError(found, T), 0.12) << "trial " << trial;
    EXPECT_NEAR(found.linear().determinant(), 1, 1e-9);
    EXPECT_LT((found.linear() * found.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-9);

    IcpParameters icp;
    icp.max_iterations = 60;
    const IcpResult refined = icpPointToPoint(KdTree(model.surface.points), scene, found, 2 * LEAF, icp);
    EXPECT_LT((refined.T_camera_object * model.center - T * model.center).norm(), 0.15 * LEAF);
    EXPECT_LT(test::rotationError(refined.T_camera_object, T), 0.02);
    EXPECT_GT(matchingRate(KdTree(model.surface.points), refined.T_camera_object, scene.points, 0.005), 0.999);
  }
}

INSTANTIATE_TEST_SUITE_P(Features, AnyFeature,
                         testing::Values(FeatureKind::Ppf, FeatureKind::CurPpfUnweighted, FeatureKind::CurPpf));

TEST(Voting, sameBitsForAnyNumberOfThreads)
{
  const TrainedModel model = test::modelOf(test::lBlock(0.0015, 1), LEAF, FeatureKind::CurPpf);
  const OrientedPoints scene = sceneOf(model, test::lBlock(0.0015, 2), Pose::Identity());
  const VotingParameters voting;
  const auto references = chooseReferences(test::everyIndex(scene.size()), voting);
  const auto one = voteForPoses(model, scene, {}, {}, references, voting, Deadline(), Executor(1));
  const auto four = voteForPoses(model, scene, {}, {}, references, voting, Deadline(), Executor(4));
  ASSERT_EQ(one.hypotheses.size(), four.hypotheses.size());
  EXPECT_EQ(one.statistics.votes, four.statistics.votes);
  for (std::size_t i = 0; i < one.hypotheses.size(); ++i)
    EXPECT_TRUE(one.hypotheses[i].T_camera_object.matrix() == four.hypotheses[i].T_camera_object.matrix());
}

TEST(Voting, curvatureSavesVotes)
{
  VotingParameters voting;
  voting.max_votes = 0;
  const auto votesOf = [&voting](FeatureKind feature) {
    const TrainedModel model = test::modelOf(test::lBlock(0.0015, 1), LEAF, feature);
    const OrientedPoints scene = sceneOf(model, test::lBlock(0.0015, 2), Pose::Identity());
    return voteForPoses(model, scene, {}, {}, chooseReferences(test::everyIndex(scene.size()), {}), voting, Deadline(),
                        Executor(2))
        .statistics.votes;
  };
  EXPECT_LT(2 * votesOf(FeatureKind::CurPpf), votesOf(FeatureKind::Ppf));
}

TEST(Voting, weightOfEquationEightAddsUp)
{
  const TrainedModel model = test::modelOf(test::lBlock(0.0015, 1), LEAF, FeatureKind::CurPpf);
  const OrientedPoints scene = sceneOf(model, test::lBlock(0.0015, 2), Pose::Identity());
  const auto total = [&](int weight) {
    VotingParameters voting;
    voting.weight = weight;
    double sum = 0;
    for (const auto& h : voteForPoses(model, scene, {}, {}, {5, 50, 100}, voting, Deadline(), Executor(1)).hypotheses)
      sum = std::max(sum, h.votes);
    return sum;
  };
  EXPECT_GT(total(5), total(1));
}

TEST(Voting, unknownCurvatureMeetsEveryBin)
{
  const TrainedModel model = test::modelOf(test::lBlock(0.0015, 1), LEAF, FeatureKind::CurPpfUnweighted);
  const TrainedModel plain = test::modelOf(test::lBlock(0.0015, 1), LEAF, FeatureKind::Ppf);
  const OrientedPoints scene = sceneOf(model, test::lBlock(0.0015, 2), Pose::Identity());
  const std::vector<std::uint8_t> unknown(scene.size(), 0);
  VotingParameters voting;
  voting.curvature_wildcard = true;
  voting.max_votes = 0;
  const auto wild = voteForPoses(model, scene, unknown, {}, {3, 33, 66}, voting, Deadline(), Executor(1));
  const auto four_dimensional = voteForPoses(plain, scene, {}, {}, {3, 33, 66}, voting, Deadline(), Executor(1));
  EXPECT_EQ(wild.statistics.votes, four_dimensional.statistics.votes);
}

TEST(Voting, longBucketsAreSkipped)
{
  const TrainedModel model = test::modelOf(test::lBlock(0.0015, 1), LEAF, FeatureKind::Ppf);
  const OrientedPoints scene = sceneOf(model, test::lBlock(0.0015, 2), Pose::Identity());
  VotingParameters capped;
  capped.max_votes = 0;
  const auto all = voteForPoses(model, scene, {}, {}, {3, 33}, capped, Deadline(), Executor(1)).statistics;
  capped.max_bucket = 50;
  const auto few = voteForPoses(model, scene, {}, {}, {3, 33}, capped, Deadline(), Executor(1)).statistics;
  EXPECT_LT(few.votes, all.votes);
  EXPECT_LE(few.votes, few.pairs * 50);
}

TEST(Voting, budgetBoundsVotesAndThinsPairsEvenly)
{
  const TrainedModel model = test::modelOf(test::lBlock(0.0015, 1), LEAF, FeatureKind::Ppf);
  const OrientedPoints scene = sceneOf(model, test::lBlock(0.0015, 2), Pose::Identity());
  VotingParameters voting;
  voting.max_votes = 0;
  const auto all = voteForPoses(model, scene, {}, {}, {3, 33}, voting, Deadline(), Executor(1)).statistics;
  voting.max_votes = static_cast<int>(all.votes / 2 / 5);  // about a fifth for either reference
  const auto thinned = voteForPoses(model, scene, {}, {}, {3, 33}, voting, Deadline(), Executor(1));
  EXPECT_EQ(thinned.statistics.pairs, all.pairs);
  // Runs are of different lengths: a fifth of the pairs has a fifth of the votes to within their scatter.
  EXPECT_LT(static_cast<double>(thinned.statistics.votes), 0.25 * static_cast<double>(all.votes));
  EXPECT_GT(static_cast<double>(thinned.statistics.votes), 0.1 * static_cast<double>(all.votes));
  ASSERT_FALSE(thinned.hypotheses.empty());
  EXPECT_LT(test::rotationError(thinned.hypotheses.front().T_camera_object, Pose::Identity()), 0.3);
}

TEST(Voting, repeatedPairsCountOnce)
{
  const TrainedModel model = test::modelOf(test::lBlock(0.0015, 1), LEAF, FeatureKind::Ppf);
  OrientedPoints scene = sceneOf(model, test::lBlock(0.0015, 2), Pose::Identity());
  VotingParameters voting;
  voting.max_votes = 0;
  const auto once = voteForPoses(model, scene, {}, {}, {3, 33}, voting, Deadline(), Executor(1));
  // Every point a second time, in the same place: nothing new is said.
  const OrientedPoints copy = scene;
  scene.points.insert(scene.points.end(), copy.points.begin(), copy.points.end());
  scene.normals.insert(scene.normals.end(), copy.normals.begin(), copy.normals.end());
  scene.curvature.insert(scene.curvature.end(), copy.curvature.begin(), copy.curvature.end());
  const auto twice = voteForPoses(model, scene, {}, {}, {3, 33}, voting, Deadline(), Executor(1));
  EXPECT_EQ(twice.statistics.votes, once.statistics.votes);
  EXPECT_GT(twice.statistics.pairs, once.statistics.pairs);
  voting.skip_repeated = false;
  const auto counted = voteForPoses(model, scene, {}, {}, {3, 33}, voting, Deadline(), Executor(1));
  EXPECT_GE(counted.statistics.votes, 2 * once.statistics.votes);
}

TEST(Voting, oneProfileOfASymmetricPartFindsItEverywhere)
{
  Symmetry revolution;
  revolution.continuous = Symmetry::Axis{Eigen::Vector3d::UnitZ(), Eigen::Vector3d::Zero()};
  const OrientedPoints dense = test::torus(0.04, 0.015, 60000, 1);
  const TrainedModel folded = test::modelOf(dense, LEAF, FeatureKind::Ppf, revolution);
  const TrainedModel whole = test::modelOf(dense, LEAF, FeatureKind::Ppf);
  EXPECT_LT(10 * folded.table.numEntries(), whole.table.numEntries());
  std::mt19937 random(12);
  for (int trial = 0; trial < 4; ++trial)
  {
    const Pose T = test::randomPose(random, 0.4);
    const OrientedPoints scene = sceneOf(folded, test::torus(0.04, 0.015, 60000, 2), T);
    const auto references = chooseReferences(test::everyIndex(scene.size()), {});
    const auto votes = voteForPoses(folded, scene, {}, {}, references, {}, Deadline(), Executor(2));
    const auto clusters = clusterPoses(votes.hypotheses, folded, {});
    ASSERT_FALSE(clusters.empty());
    const Pose& found = clusters.front().T_camera_object;
    // The torus is its own mirror image: its axis may point either way.
    const double cosine = std::abs((found.linear() * Eigen::Vector3d::UnitZ()).dot(T.linear().col(2)));
    EXPECT_GT(cosine, std::cos(0.15)) << "trial " << trial;
    EXPECT_LT((found.translation() - T.translation()).norm(), LEAF) << "trial " << trial;
  }
}

TEST(Voting, passedDeadlineIsPartialAndHasNoPoses)
{
  const TrainedModel model = test::modelOf(test::lBlock(0.002, 1), LEAF, FeatureKind::Ppf);
  const OrientedPoints scene = sceneOf(model, test::lBlock(0.002, 2), Pose::Identity());
  Deadline deadline(1e-9);
  while (!deadline.passed())
  {}
  const auto votes = voteForPoses(model, scene, {}, {}, {1, 2, 3}, {}, deadline, Executor(1));
  EXPECT_TRUE(votes.partial);
  EXPECT_TRUE(votes.hypotheses.empty());
}

TEST(ChooseReferences, drawsTheAskedShareEvenly)
{
  VotingParameters voting;
  voting.reference_share = 0.2;
  voting.min_references = 1;
  const auto references = chooseReferences(test::everyIndex(1000), voting);
  ASSERT_EQ(references.size(), 200u);
  for (std::size_t i = 0; i < references.size(); ++i)
    EXPECT_EQ(references[i], static_cast<int>(5 * i));
  voting.min_references = 50;
  EXPECT_EQ(chooseReferences(test::everyIndex(30), voting).size(), 30u);
  EXPECT_TRUE(chooseReferences({}, voting).empty());
}

/// Points a leaf apart on a square plate, `width` of them along each edge.
std::vector<Eigen::Vector3f> plate(int width, double leaf, const Eigen::Vector3f& corner)
{
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < width * width; ++i)
    points.push_back(corner + static_cast<float>(leaf) *
                                  Eigen::Vector3f(static_cast<float>(i % width), static_cast<float>(i / width), 0));
  return points;
}

TEST(SpreadReferences, drawsTheAskedShareOfAPlane)
{
  VotingParameters voting;
  voting.reference_share = 0.04;  // cubes of 5 x 5 points
  voting.min_references = 1;
  const auto points = plate(100, LEAF, Eigen::Vector3f::Constant(0.5f * static_cast<float>(LEAF)));
  EXPECT_EQ(spreadReferences(points, LEAF, voting).size(), 400u);
  EXPECT_TRUE(spreadReferences({}, LEAF, voting).empty());
}

TEST(SpreadReferences, givesASmallSurfaceItsOwn)
{
  VotingParameters voting;
  voting.reference_share = 0.04;
  voting.min_references = 1;
  auto points = plate(100, LEAF, Eigen::Vector3f::Zero());
  const std::size_t large = points.size();
  const auto patch = plate(3, LEAF, Eigen::Vector3f(0, 0, 0.05f));  // 9 points: a share of 4 % may miss them
  points.insert(points.end(), patch.begin(), patch.end());
  const auto references = spreadReferences(points, LEAF, voting);
  EXPECT_TRUE(std::is_sorted(references.begin(), references.end()));
  EXPECT_GE(references.back(), static_cast<int>(large));
}

TEST(SpreadReferences, drawsMoreWhereTheyWouldBeTooFew)
{
  VotingParameters voting;
  voting.reference_share = 0.04;
  voting.min_references = 30;
  const auto points = plate(10, LEAF, Eigen::Vector3f::Constant(0.5f * static_cast<float>(LEAF)));
  EXPECT_GE(spreadReferences(points, LEAF, voting).size(), 30u);
  voting.min_references = 1000;
  EXPECT_EQ(spreadReferences(points, LEAF, voting).size(), points.size());
}

TEST(AveragePoses, isRigidAndBetweenItsPoses)
{
  std::mt19937 random(5);
  const Pose T = test::randomPose(random, 0.5);
  const Eigen::Vector3d center(0.02, -0.01, 0.03);
  std::vector<Pose> poses;
  for (const double angle : {-0.1, 0.1})
  {
    Pose turned = T;
    turned.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix() * T.linear();
    turned.translation() = T * center - turned.linear() * center;  // turned about the centre
    poses.push_back(turned);
  }
  const Pose mean = averagePoses(poses, {1, 1}, center);
  EXPECT_LT((mean * center - T * center).norm(), 1e-12);
  EXPECT_LT(test::rotationError(mean, T), 1e-9);
  EXPECT_NEAR(mean.linear().determinant(), 1, 1e-12);
}

TEST(ClusterPoses, joinsWhatIsNearAndSymmetricAndKeepsTheRestApart)
{
  TrainedModel model;
  model.diameter = 0.1;
  Pose half_turn = Pose::Identity();
  half_turn.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  std::mt19937 random(6);
  const Pose T = test::randomPose(random, 0.5);
  Pose near = T;
  near.translation().x() += 0.004;
  Pose far = T;
  far.translation().x() += 0.2;
  const std::vector<Hypothesis> hypotheses = {
      {T, 10, 0, 0}, {near, 8, 1, 0}, {T * half_turn, 6, 2, 0}, {far, 12, 3, 0}};

  EXPECT_EQ(clusterPoses(hypotheses, model, {}).size(), 3u);
  model.symmetry.discrete.push_back(half_turn);
  const auto clusters = clusterPoses(hypotheses, model, {});
  ASSERT_EQ(clusters.size(), 2u);
  EXPECT_EQ(clusters[0].members, 3);
  EXPECT_DOUBLE_EQ(clusters[0].votes, 24);
  EXPECT_LT(test::rotationError(clusters[0].T_camera_object, T), 1e-6);
  EXPECT_NEAR((clusters[0].T_camera_object.translation() - T.translation()).norm(), 0.004 * 8 / 24, 1e-9);
}

TEST(IcpPointToPoint, isExactOnItsOwnPointsAndRigidOnPlanes)
{
  const OrientedPoints model = test::lBlock(0.002, 1);
  std::mt19937 random(8);
  const Pose T = test::randomPose(random, 0.4);
  Pose start = T;
  start.translation() += 0.001 * test::unitVector(random);
  IcpParameters icp;
  icp.max_iterations = 100;
  const IcpResult result = icpPointToPoint(KdTree(model.points), transformed(model, T), start, 0.01, icp);
  EXPECT_TRUE(result.converged);
  EXPECT_LT((result.T_camera_object.translation() - T.translation()).norm(), 1e-5);
  EXPECT_LT(result.rms, 1e-6);

  const OrientedPoints flat = test::plane(0.05, 400);
  const IcpResult on_plane = icpPointToPoint(KdTree(flat.points), transformed(flat, T), T, 0.01, icp);
  EXPECT_NEAR(on_plane.T_camera_object.linear().determinant(), 1, 1e-9)
      << "a reflection fits a plane as well, but is no pose";
}

TEST(IcpPointToPoint, withoutCorrespondencesThePoseStaysAndRmsIsNan)
{
  const OrientedPoints model = test::lBlock(0.002, 1);
  Pose far = Pose::Identity();
  far.translation().x() = 1;
  const IcpResult result = icpPointToPoint(KdTree(model.points), model, far, 0.01, {});
  EXPECT_TRUE(std::isnan(result.rms));
  EXPECT_EQ(result.iterations, 0);
  EXPECT_TRUE(result.T_camera_object.matrix() == far.matrix());
}

TEST(MatchingRate, countsTheShareWithinTheDistance)
{
  const KdTree model(test::plane(0.1, 20000).points);
  std::vector<Eigen::Vector3f> scene = {{0, 0, 0.001f}, {0, 0, 0.004f}, {0, 0, 0.006f}, {0, 0, 0.1f}};
  EXPECT_DOUBLE_EQ(matchingRate(model, Pose::Identity(), scene, 0.005), 0.5);
  EXPECT_DOUBLE_EQ(matchingRate(model, Pose::Identity(), {}, 0.005), 0);
}
/// The rims of a plate's two large faces, a point every 4 mm, each with the direction out of the face.
/// \param shift of the first point along each side
OrientedPoints rims(const Eigen::Vector3f& half, bool both, float shift)
{
  OrientedPoints edges;
  const auto side = [&](int across, float z) {
    const int along = 1 - across;
    for (const float end : {-1.0f, 1.0f})
      for (float t = -half[along] + shift; t <= half[along]; t += 0.004f)
      {
        Eigen::Vector3f p(0, 0, z);
        p[across] = end * half[across];
        p[along] = t;
        edges.points.push_back(p);
        edges.normals.push_back(end * Eigen::Vector3f::Unit(across));
      }
  };
  for (const int across : {0, 1})
  {
    side(across, half.z());
    if (both)
      side(across, -half.z());
  }
  return edges;
}

OrientedPoints face(const Eigen::Vector3f& half, float z, float spacing, float shift)
{
  OrientedPoints points;
  for (float x = -half.x() + shift; x < half.x(); x += spacing)
    for (float y = -half.y() + shift; y < half.y(); y += spacing)
    {
      points.points.emplace_back(x, y, z * half.z());
      points.normals.emplace_back(0, 0, z);
    }
  return points;
}

// All pairs on a plane look alike but for their length. Half of a plate's face, whose cut is no end of it, has its
// place on the plate only by the three ends that are seen.
TEST(EdgeVotes, tellWhereOnAFaceAPointLies)
{
  const Eigen::Vector3f half(0.045f, 0.03f, 0.004f);
  OrientedPoints dense = face(half, 1, 0.001f, 0);
  const OrientedPoints back = face(half, -1, 0.001f, 0);
  dense.points.insert(dense.points.end(), back.points.begin(), back.points.end());
  dense.normals.insert(dense.normals.end(), back.normals.begin(), back.normals.end());
  TrainedModel model = test::modelOf(dense, LEAF, FeatureKind::Ppf);
  model.edges = rims(half, true, 0);
  PairSelection selection;
  selection.min_distance = LEAF;
  selection.references = model.table.references();
  model.edge_table = FeatureTable(model.points, model.edges, selection, model.table.quantizer(), Executor(1));

  const auto is_seen = [](const Eigen::Vector3f& p) { return p.x() > 0; };
  const auto keep = [&](const OrientedPoints& all) {
    std::vector<int> kept;
    for (std::size_t i = 0; i < all.size(); ++i)
      if (is_seen(all.points[i]))
        kept.push_back(static_cast<int>(i));
    return select(all, kept);
  };
  OrientedPoints scene = keep(face(half, 1, 0.001f, 0.0004f));
  OrientedPoints edges = keep(rims(half, false, 0.0013f));
  std::mt19937 random(5);
  const Pose T = test::randomPose(random, 0.3);
  scene = voxelDownsample(transformed(scene, T), LEAF);
  edges = transformed(edges, T);

  // A plate has four poses that look the same; its middle is the same in all of them.
  const auto numRight = [&](int edge_weight) {
    VotingParameters voting;
    voting.edge_weight = edge_weight;
    voting.max_votes = 0;
    voting.peaks_per_reference = 1;
    const auto votes =
        voteForPoses(model, scene, {}, edges, test::everyIndex(scene.size()), voting, Deadline(), Executor(2));
    EXPECT_EQ(votes.hypotheses.size(), scene.size());
    return std::count_if(votes.hypotheses.begin(), votes.hypotheses.end(), [&](const Hypothesis& h) {
      return (h.T_camera_object * model.center - T * model.center).norm() < 2 * LEAF;
    });
  };
  const auto without = numRight(0);
  const auto with = numRight(3);
  EXPECT_LT(without, 0.25 * static_cast<double>(scene.size()));
  EXPECT_GT(with, 0.7 * static_cast<double>(scene.size()));
}
}  // namespace
}  // namespace bin_picking
