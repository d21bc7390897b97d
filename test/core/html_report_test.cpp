// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/html_report.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "bin_picking_perception/common/error.hpp"
#include "core/dataset_folders.hpp"

namespace bin_picking
{
namespace
{
using namespace test;

PartShapes shapes()
{
  Symmetry symmetry;
  symmetry.discrete.emplace_back(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()));
  return {{"bar", makePartShape(barMesh(), symmetry)}};
}

JudgedScene judged(const std::string& name, const std::vector<PoseEstimate>& estimates)
{
  EvaluationScene scene;
  scene.name = name;
  scene.parts = {"bar"};
  scene.instances.resize(1);
  scene.instances[0].part = "bar";
  scene.instances[0].T_camera_object = barPose();
  scene.instances[0].visible_fraction = 0.93;
  JudgedScene result = judgeScene(scene, estimates, shapes(), {});
  result.runs = {{0.123, {{"voting", 0.1}}, {}}};
  return result;
}

PoseEstimate shifted(double shift, double score)
{
  return {"bar", Eigen::Translation3d(shift, 0, 0) * barPose(), score};
}

EvaluationReport report(const std::vector<JudgedScene>& scenes)
{
  EvaluationReport report;
  report.title = "a <set> & more";
  report.details = {{"preset", "fast"}};
  report.scenes = scenes;
  report.summary = summarize(scenes, {"bar"}, report.parameters);
  for (const JudgedScene& scene : scenes)
    report.pictures.push_back(drawScene(barScan(barPose()), scene, shapes()));
  return report;
}

std::size_t count(const std::string& text, const std::string& words)
{
  std::size_t found = 0;
  for (auto at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
    ++found;
  return found;
}

/// The corner points of an outline, in the order that they are drawn.
std::vector<Eigen::Vector2d> cornersOf(const std::string& path)
{
  std::vector<Eigen::Vector2d> corners;
  std::istringstream in(path);
  Eigen::Vector2d at(0, 0);
  for (char command = 0; in >> command;)
    if (command != 'z')
    {
      Eigen::Vector2d step;
      in >> step.x() >> step.y();
      at = command == 'M' ? step : Eigen::Vector2d(at + step);
      corners.push_back(at);
    }
  return corners;
}

TEST(ScenePicture, OutlinesLieWhereThePartIs)
{
  const ScenePicture picture = drawScene(barScan(barPose()), judged("one", {shifted(0, 1)}), shapes());
  EXPECT_EQ(picture.width, 160);
  const cv::Mat decoded = cv::imdecode(std::vector<uchar>(picture.jpeg.begin(), picture.jpeg.end()), cv::IMREAD_COLOR);
  EXPECT_EQ(decoded.size(), cv::Size(160, 120));
  ASSERT_EQ(picture.estimates.size(), 1u);
  EXPECT_TRUE(picture.instances.at(0).path.empty()) << "it was found";
  Eigen::AlignedBox2d drawn;
  for (const Eigen::Vector2d& corner : cornersOf(picture.estimates[0].path))
    drawn.extend(corner);
  Eigen::AlignedBox2d projected;
  for (const Eigen::Vector3f& vertex : barMesh().vertices)
    projected.extend(pictureCamera().project(barPose() * vertex.cast<double>()));
  // In the picture, pixel k lies between k and k + 1.
  EXPECT_LT((drawn.min() - projected.min() - Eigen::Vector2d(0.5, 0.5)).norm(), 0.5);
  EXPECT_LT((drawn.max() - projected.max() - Eigen::Vector2d(0.5, 0.5)).norm(), 0.5);
  EXPECT_TRUE(drawn.contains(picture.estimates[0].anchor));
  EXPECT_THROW(drawScene(makeGrid(0, 0, pictureCamera()), judged("none", {}), shapes()), ParameterError);
}

TEST(ScenePicture, APoseOutsideOfThePictureHasNoOutline)
{
  const JudgedScene scene = judged("far", {shifted(300, 1)});
  const ScenePicture picture = drawScene(barScan(barPose()), scene, shapes());
  EXPECT_TRUE(picture.estimates[0].path.empty());
  EXPECT_FALSE(picture.instances[0].path.empty()) << "missed";
  EXPECT_NE(htmlReport(report({scene})).find("no part there"), std::string::npos);
}

TEST(HtmlReport, NeedsNothingFromOutside)
{
  const std::string page = htmlReport(report({judged("one", {shifted(0, 0.9)}), judged("two", {})}));
  EXPECT_EQ(count(page, "src=\"data:image/jpeg;base64,/9j/"), 2u);  // how every JPEG begins
  EXPECT_EQ(count(page, "src="), 2u);
  for (const char* outside : {"http:", "https:", "//cdn", "<link", "@import", "url(", "href="})
    EXPECT_EQ(count(page, outside), 0u) << outside;
  EXPECT_EQ(count(page, "<script>"), 1u);
  EXPECT_NE(page.find("prefers-color-scheme: dark"), std::string::npos);
  EXPECT_NE(page.find("a &lt;set&gt; &amp; more"), std::string::npos);
  EXPECT_EQ(page.find("<set>"), std::string::npos);
}

TEST(HtmlReport, SaysWhatIsRightWrongAndMissed)
{
  const std::string page =
      htmlReport(report({judged("good", {shifted(0.001, 0.95)}), judged("missing", {}),
                         judged("bad", {shifted(0.02, 0.9)}), judged("twice", {shifted(0, 0.9), shifted(0, 0.8)})}));
  const auto at = [&](const std::string& words) { return page.find(words); };
  EXPECT_LT(at("<b>bad"), at("<b>twice"));
  EXPECT_LT(at("<b>twice"), at("<b>missing"));
  EXPECT_LT(at("<b>missing"), at("<b>good"));
  expectWords(page, {"#1 right: 1.00 mm, 0.00 deg, score 0.950", "#1 off by 20.0 mm, 0.0 deg", "#2 duplicate of #1",
                     "missed: 93.0 % visible", "All 4", "Wrong 1", "Duplicate 1", "Missed 2", "Flawless 1",
                     "2 of 4 (15–85 %)", "voting"});
  EXPECT_EQ(count(page, "class=\"mark-right\""), 2u);
  EXPECT_EQ(count(page, "class=\"mark-wrong\""), 1u);
  EXPECT_EQ(count(page, "class=\"mark-duplicate\""), 1u);
  EXPECT_EQ(count(page, "class=\"mark-missed\""), 2u);
}

TEST(HtmlReport, ShowsOpenTurnsOnlyWhereThereAreSome)
{
  PoseEstimate open = shifted(0, 0.9);
  EXPECT_EQ(htmlReport(report({judged("known", {open})})).find("Found with their turn"), std::string::npos);
  open.undetermined_turn = UndeterminedTurn{{Eigen::Vector3d::UnitX(), Eigen::Vector3d::Zero()}, {}, 0.001};
  const std::string page = htmlReport(report({judged("open", {open}), judged("known", {shifted(0, 0.9)})}));
  expectWords(page, {"Right, of poses with an open turn", "Found with their turn, of those 85 % visible",
                     "#1 right up to its turn: 0.00 mm", "1 of 2 ("});
}

TEST(HtmlReport, HoldsScoresAgainstTruthWherePosesWereTested)
{
  JudgedScene scene = judged("one", {shifted(0, 0.95)});
  EXPECT_EQ(count(htmlReport(report({scene})), "Brier score "), 0u);
  scene.tested = {{"bar", 0.95, {}, true, true}, {"bar", 0.25, {}, false, true}, {"bar", 0.15, {}, false, false}};
  const std::string page = htmlReport(report({scene}));
  expectWords(page, {"3 poses tested in full", "Brier score 0.196, expected calibration error 31.7 %",
                     "<td>0.9–1.0</td><td>1</td><td>95.0 %</td><td>100.0 %"});
  EXPECT_EQ(count(page, "<td class=\"reliability\">"), 3u) << "a line for every tenth that has poses";
}

TEST(HtmlReport, EverySceneHasItsPicture)
{
  EvaluationReport incomplete = report({judged("one", {})});
  incomplete.pictures.clear();
  EXPECT_THROW(htmlReport(incomplete), ParameterError);
}
}  // namespace
}  // namespace bin_picking
