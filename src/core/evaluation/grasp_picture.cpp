// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/grasp_picture.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/evaluation/picture_file.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "part_drawing.hpp"

namespace bin_picking
{
namespace
{
constexpr int TILE = 360;  // pixels
constexpr int TITLE = 26;  // of it, for the name
constexpr int COLUMNS = 4;
constexpr double FAR = 3.0;      // metres to the camera: nearly parallel rays
constexpr double MARGIN = 0.03;  // metres round the part
const cv::Scalar BACKGROUND(255, 255, 255);
const cv::Scalar BLACK(40, 30, 30), RED(30, 30, 220);  // blue, green, red

enum Label
{
  PART,
  PAD,
  GRIPPER
};

cv::Vec3f colorOf(std::int32_t label)
{
  if (label == PART)
    return {190, 190, 185};
  return label == PAD ? cv::Vec3f(40, 140, 250) : cv::Vec3f(190, 120, 70);
}

/// Looks at the tip from aside; the approach points down in the picture, the closing axis to the right.
Pose viewOfTip()
{
  const Eigen::Vector3d from = Eigen::Vector3d(-1, 0.5, -0.45).normalized();  // to the camera, tip frame
  Pose T_camera_tip = Pose::Identity();
  const Eigen::Vector3d forward = -from;
  const Eigen::Vector3d down = (Eigen::Vector3d::UnitZ() - forward.z() * forward).normalized();
  T_camera_tip.linear().row(0) = down.cross(forward);
  T_camera_tip.linear().row(1) = down;
  T_camera_tip.linear().row(2) = forward;
  T_camera_tip.translation() = Eigen::Vector3d(0, 0, FAR);
  return T_camera_tip;
}

/// Half of what a tile shows, metres.
double fieldOf(const TriangleMesh& mesh, const std::vector<DrawnGrasp>& grasps)
{
  double radius = 0.05;
  for (const DrawnGrasp& drawn : grasps)
    for (const Eigen::Vector3f& v : mesh.vertices)
      radius = std::max(radius, (v.cast<double>() - drawn.grasp.T_object_tip.translation()).norm());
  return radius + MARGIN;
}

void drawScene(const TriangleMesh& mesh, const Gripper& gripper, const GraspDefinition& grasp, DepthRenderer& renderer)
{
  const Pose T_camera_tip = viewOfTip();
  renderer.draw(mesh, T_camera_tip * grasp.T_object_tip.inverse(), PART);
  const double width = std::clamp(grasp.width, gripper.min_opening, gripper.max_opening);
  const Pose T_camera_tool0 = T_camera_tip * gripper.T_tool0_tip(width).inverse();
  for (std::size_t b = 0; b < gripper.bodies.size(); ++b)
    renderer.draw(toMesh(gripper.bodyAt(b, width)), T_camera_tool0, gripper.bodies[b].touches_part ? PAD : GRIPPER);
}

void paint(const DepthRenderer& renderer, cv::Mat& tile)
{
  const DepthGrid grid = renderer.grid();
  const auto normals = estimateGridNormals(grid, 1.5 * grid.pitch(FAR), Executor(1));
  for (std::size_t i = 0; i < grid.size(); ++i)
  {
    if (!grid.valid(static_cast<int>(i)))
      continue;
    const cv::Vec3f color = colorOf(renderer.labels()[i]) * shade(normals[i]);
    tile.at<cv::Vec3b>(static_cast<int>(i) / TILE, static_cast<int>(i) % TILE) = cv::Vec3b(
        cv::saturate_cast<uchar>(color[0]), cv::saturate_cast<uchar>(color[1]), cv::saturate_cast<uchar>(color[2]));
  }
}

cv::Mat drawTile(const TriangleMesh& mesh, const Gripper& gripper, const DrawnGrasp& drawn, double field)
{
  const double focal = FAR * TILE / (2 * field), middle = (TILE - 1) / 2.0;
  DepthRenderer renderer(TILE, TILE, {focal, focal, middle, middle + TILE / 8.0});
  drawScene(mesh, gripper, drawn.grasp, renderer);
  cv::Mat tile(TILE, TILE, CV_8UC3, BACKGROUND);
  paint(renderer, tile);
  const bool good = drawn.check.good();
  if (!good && drawn.check.clearance < 0)
  {
    const Eigen::Vector2d at =
        renderer.camera().project(viewOfTip() * drawn.grasp.T_object_tip.inverse() * drawn.check.closest_at);
    cv::circle(tile, cv::Point(static_cast<int>(at.x()), static_cast<int>(at.y())), 7, RED, 2, cv::LINE_AA);
  }
  cv::rectangle(tile, {0, 0, TILE, TITLE}, BACKGROUND, cv::FILLED);
  const auto write = [&](const std::string& text, int y) {
    cv::putText(tile, text, {8, y}, cv::FONT_HERSHEY_SIMPLEX, 0.42, good ? BLACK : RED, 1, cv::LINE_AA);
  };
  write(drawn.grasp.id, 18);
  write(good ? "holds" : toString(drawn.check.findings.front().fault), TILE - 8);
  cv::rectangle(tile, {0, 0, TILE, TILE}, cv::Scalar(200, 200, 200));
  return tile;
}
}  // namespace

void saveGraspPicture(const TriangleMesh& mesh, const Gripper& gripper, const std::vector<DrawnGrasp>& grasps,
                      const std::string& path)
{
  if (grasps.empty())
    throw ParameterError("there are no grasps to draw; write some into the part.yaml, or have some proposed");
  const int count = static_cast<int>(grasps.size());
  const int columns = std::min(COLUMNS, count), rows = (count + columns - 1) / columns;
  cv::Mat picture(rows * TILE, columns * TILE, CV_8UC3, BACKGROUND);
  const double field = fieldOf(mesh, grasps);
  for (int k = 0; k < count; ++k)
    drawTile(mesh, gripper, grasps[static_cast<std::size_t>(k)], field)
        .copyTo(picture(cv::Rect(k % columns * TILE, k / columns * TILE, TILE, TILE)));
  writePicture(picture, path);
}
}  // namespace bin_picking
