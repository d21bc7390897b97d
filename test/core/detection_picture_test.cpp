// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/evaluation/detection_picture.hpp"
#include "core/analytic_scenes.hpp"

using namespace bin_picking;
using namespace bin_picking::test;

namespace
{
/// A square of 60 mm in the plane z = 0 of the part.
std::shared_ptr<const TrainedModel> plateModel()
{
  auto model = std::make_shared<TrainedModel>();
  model->mesh.vertices = {{-0.03f, -0.03f, 0}, {0.03f, -0.03f, 0}, {0.03f, 0.03f, 0}, {-0.03f, 0.03f, 0}};
  model->mesh.triangles = {{0, 2, 1}, {0, 3, 2}};
  return model;
}

Detection plateAt(double x, double y, double z)
{
  Detection detection;
  detection.T_camera_object.translation() = Eigen::Vector3d(x, y, z);
  detection.score = 0.93;
  return detection;
}

/// How much redder than blue the picture is around a point given in pixels of the grid.
double redness(const cv::Mat& picture, const DepthGrid& grid, const Eigen::Vector3d& p)
{
  const int scale = picture.cols / grid.width;
  const Eigen::Vector2d at = grid.camera.project(p) * scale;
  const cv::Vec3b pixel = picture.at<cv::Vec3b>(static_cast<int>(at.y()), static_cast<int>(at.x()));
  return static_cast<double>(pixel[2]) - static_cast<double>(pixel[0]);
}
}  // namespace

TEST(DetectionPicture, PartsAreColouredWhereTheyAreAndDimWhereTheyAreHidden)
{
  // The first part lies on a table; half of the second is below it.
  const DepthGrid grid = render({plane({0, 0, 0.8}, {0, 0, -1})});
  DetectionResult result;
  result.message = "2 parts found";
  result.detections = {plateAt(-0.08, 0, 0.798), plateAt(0.08, 0, 0.798)};
  result.detections[1].T_camera_object.linear() = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
  const std::string path = testing::TempDir() + "detections.png";
  saveDetectionPicture(grid, result, {plateModel()}, path);

  const cv::Mat picture = cv::imread(path);
  ASSERT_GE(picture.cols, 900);
  EXPECT_EQ(picture.cols % grid.width, 0);
  EXPECT_GT(picture.rows, grid.height * (picture.cols / grid.width));  // room for the message
  EXPECT_GT(redness(picture, grid, {-0.08, 0.02, 0.8}), 40);
  EXPECT_LT(std::abs(redness(picture, grid, {0, 0, 0.8})), 5);  // the table stays gray
  const double above = redness(picture, grid, {0.08, -0.02, 0.789});
  const double below = redness(picture, grid, {0.08, 0.02, 0.809});
  EXPECT_GT(above, 40);
  EXPECT_GT(below, 5);
  EXPECT_LT(below, above / 2);
}

TEST(DetectionPicture, NothingFoundIsAPictureToo)
{
  DetectionResult result;
  result.message =
      "Nothing was recognised among 1234 measured points: a message of more than one line has to be broken "
      "so that it does not run out of the picture on the right.";
  const std::string path = testing::TempDir() + "nothing.jpg";
  saveDetectionPicture(makeGrid(64, 48, testCamera()), result, {}, path);
  EXPECT_FALSE(cv::imread(path).empty());
}

TEST(DetectionPicture, WhatCannotBeWrittenIsSaid)
{
  const DepthGrid grid = render({plane({0, 0, 0.8}, {0, 0, -1})}, 32, 24);
  EXPECT_THROW(saveDetectionPicture(grid, {}, {}, testing::TempDir() + "no_such_folder/a.png"), FileError);
  EXPECT_THROW(saveDetectionPicture(grid, {}, {}, testing::TempDir() + "a.unknown"), FileError);
  EXPECT_THROW(saveDetectionPicture(makeGrid(0, 0, testCamera()), {}, {}, testing::TempDir() + "a.png"),
               ParameterError);
}

TEST(DetectionPicture, ColoursAreThoseOfThePaper)
{
  EXPECT_GT(rankColor(0).x(), rankColor(0).y() + 0.5f);  // red
  EXPECT_GT(rankColor(3).y(), rankColor(3).x() + 0.5f);  // green
  EXPECT_GT(rankColor(4).z(), rankColor(4).x() + 0.5f);  // blue
  EXPECT_EQ(rankColor(5), rankColor(50));
  EXPECT_NE(rankColor(4), rankColor(5));
}
