// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "part_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"
#include "bin_picking_perception/scene/preprocessing.hpp"
#include "bin_picking_perception/segmentation/segmentation.hpp"

namespace bin_picking
{
namespace
{
constexpr double NORMAL_PIXELS = 1.5;                                 // window of the normals that shade a surface
const cv::Vec3f NO_DATA(34, 26, 22);                                  // blue, green, red
const Eigen::Vector3f LIGHT = Eigen::Vector3f(-0.4f, -0.5f, -0.77f);  // from the upper left, behind the camera

std::vector<Eigen::Vector3f> pictureNormals(const DepthGrid& grid, double depth)
{
  return estimateGridNormals(grid, NORMAL_PIXELS * grid.pitch(depth), Executor(1));
}

cv::Rect coveredWindow(const std::vector<Eigen::Vector3f>& points, const Pose& T_camera_object,
                       const PinholeCamera& camera, const cv::Size& size)
{
  Eigen::Vector2d low(size.width, size.height);
  Eigen::Vector2d high(-1, -1);
  for (const auto& point : points)
  {
    const Eigen::Vector3d p = T_camera_object * point.cast<double>();
    if (p.z() <= 0)
      continue;
    low = low.cwiseMin(camera.project(p));
    high = high.cwiseMax(camera.project(p));
  }
  const cv::Point corner(static_cast<int>(std::max(0.0, low.x() - 3)), static_cast<int>(std::max(0.0, low.y() - 3)));
  const cv::Point opposite(static_cast<int>(std::min(size.width - 1.0, high.x() + 3)),
                           static_cast<int>(std::min(size.height - 1.0, high.y() + 3)));
  return opposite.x < corner.x || opposite.y < corner.y ? cv::Rect() : cv::Rect(corner, opposite + cv::Point(1, 1));
}

}  // namespace

float shade(const Eigen::Vector3f& normal)
{
  return std::isnan(normal.x()) ? 0.5f : 0.3f + 0.7f * std::max(0.0f, normal.dot(LIGHT));
}

cv::Mat shadedDepth(const DepthGrid& grid)
{
  const auto gray = depthToGray(grid, SegmentationParameters(), nullptr);
  const auto middle = std::find_if(grid.z.begin(), grid.z.end(), [](float z) { return !std::isnan(z); });
  const auto normals = pictureNormals(grid, middle == grid.z.end() ? 1.0 : static_cast<double>(*middle));
  cv::Mat picture(grid.height, grid.width, CV_32FC3, cv::Scalar(NO_DATA[0], NO_DATA[1], NO_DATA[2]));
  for (std::size_t i = 0; i < gray.size(); ++i)
  {
    if (gray[i] == 0)
      continue;
    const float level = (0.25f + 0.75f * static_cast<float>(gray[i]) / 255) * (0.35f + 0.65f * shade(normals[i])) * 230;
    picture.at<cv::Vec3f>(static_cast<int>(i) / grid.width, static_cast<int>(i) % grid.width) = {level, level, level};
  }
  return picture;
}

PinholeCamera enlarged(const PinholeCamera& c, int scale)
{
  const double middle = (scale - 1) / 2.0;  // pixel 0 becomes pixels 0 ... scale - 1
  return {c.fx * scale, c.fy * scale, c.cx * scale + middle, c.cy * scale + middle};
}

PartDrawing drawPart(const TriangleMesh& mesh, const OrientedPoints& surface, double radius,
                     const Pose& T_camera_object, const PinholeCamera& camera, const cv::Size& size)
{
  PartDrawing drawing;
  drawing.window = coveredWindow(mesh.empty() ? surface.points : mesh.vertices, T_camera_object, camera, size);
  if (drawing.window.empty())
    return drawing;
  DepthRenderer renderer(drawing.window.width, drawing.window.height,
                         {camera.fx, camera.fy, camera.cx - drawing.window.x, camera.cy - drawing.window.y});
  if (mesh.empty())
    renderer.draw(surface, T_camera_object, radius, 0);
  else
    renderer.draw(mesh, T_camera_object, 0);
  drawing.grid = renderer.grid();
  drawing.normals = pictureNormals(drawing.grid, std::max(1e-3, T_camera_object.translation().z()));
  return drawing;
}

std::vector<std::vector<cv::Point>> contours(const PartDrawing& drawing)
{
  if (drawing.window.empty())
    return {};
  cv::Mat mask = cv::Mat::zeros(drawing.window.size(), CV_8U);
  forEachPixel(drawing,
               [&](const cv::Point& at, std::size_t) { mask.at<std::uint8_t>(at - drawing.window.tl()) = 255; });
  std::vector<std::vector<cv::Point>> found;
  cv::findContours(mask, found, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE, drawing.window.tl());
  return found;
}
}  // namespace bin_picking
