// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/scene/cloud_input.hpp"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <cmath>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
/// Why no point is a measurement.
struct PointCounts
{
  std::size_t not_finite = 0;  ///< NaN, infinite or absurdly large
  std::size_t zero = 0;
  std::size_t behind = 0;  ///< z <= 0
};

[[noreturn]] void fail(CloudFault fault, const std::ostringstream& message) { throw CloudError(fault, message.str()); }

void requireOrganized(const pcl::PointCloud<pcl::PointXYZ>& cloud)
{
  std::ostringstream m;
  if (cloud.points.empty())
  {
    m << "The point cloud is empty (" << cloud.width << " x " << cloud.height
      << " points); at least one measured point is needed. Check that the sensor has taken a picture.";
    fail(CloudFault::Empty, m);
  }
  if (static_cast<std::size_t>(cloud.width) * cloud.height != cloud.points.size())
  {
    m << "The point cloud says that it has " << cloud.width << " x " << cloud.height << " points but holds "
      << cloud.points.size() << "; the numbers must agree. Set width and height in the program that fills it.";
    fail(CloudFault::BadLayout, m);
  }
  if (cloud.height < 2 || cloud.width < 2)
  {
    m << "The point cloud is not organized: it has " << cloud.width << " x " << cloud.height
      << " points, but width and height must both be at least 2, one point per pixel of the sensor. Publish the "
         "organized "
         "cloud and do not pass it through filters that drop points.";
    fail(CloudFault::Unorganized, m);
  }
}

PointCounts countFaults(const PointView& points)
{
  PointCounts counts;
  for (int i = 0; i < static_cast<int>(points.size()); ++i)
  {
    const Eigen::Vector3f p = points.point(i);
    if (!(p.array().abs() <= PointView::MAX_COORDINATE).all())  // NaN is not either
      ++counts.not_finite;
    else if (p.isZero(0))
      ++counts.zero;
    else
      ++counts.behind;
  }
  return counts;
}

[[noreturn]] void failWithoutMeasurement(const PointView& points)
{
  const PointCounts counts = countFaults(points);
  std::ostringstream m;
  if (counts.behind > 0)
  {
    m << "All " << counts.behind << " measured points have z <= 0, but depth must be positive: the cloud is not in the "
      << "camera's optical frame (z forward, x right, y down). Transform it into the optical frame.";
    fail(CloudFault::NoProjection, m);
  }
  m << "The point cloud has no measured point: " << counts.not_finite << " are NaN, infinite or beyond 1e6 and "
    << counts.zero
    << " are (0, 0, 0); at least one must be measured. Check exposure, distance and that nothing covers the "
    << "sensor.";
  fail(CloudFault::AllInvalid, m);
}

void requireMeasurementsInMetres(const PointView& points, const InputParameters& parameters)
{
  const double median = medianDepth(points);
  if (std::isnan(median))
    failWithoutMeasurement(points);
  if (median <= parameters.max_plausible_depth)
    return;
  std::ostringstream m;
  m << "The median depth is " << median << ", above max_plausible_depth = " << parameters.max_plausible_depth
    << " m: the cloud looks like millimetres. Scale it to metres (" << median / 1000
    << " m) in the driver, or raise max_plausible_depth if the scene really is that far away.";
  fail(CloudFault::UnitSuspect, m);
}

void requirePinhole(const PinholeCamera& camera, double error, const InputParameters& parameters)
{
  std::ostringstream m;
  const char* const cure =
      " Use the cloud as the driver publishes it, in the camera's optical frame (z forward, x right, y "
      "down), with one point per pixel in the order of the image.";
  if (!std::isfinite(error))
  {
    m << "No pinhole camera can be fitted to the cloud: its measured points are fewer than three, or lie in one row or "
      << "column of pixels, or on one ray." << cure;
    fail(CloudFault::NoProjection, m);
  }
  if (error > parameters.max_projection_error)
  {
    m << "The points miss the rays of their pixels by " << error
      << " pixels (median), above max_projection_error = " << parameters.max_projection_error
      << " pixels: the cloud was not taken by one pinhole camera, or it was moved or "
      << "reordered after that." << cure;
    fail(CloudFault::NoProjection, m);
  }
  if (camera.fx <= 0 || camera.fy <= 0)
  {
    m << "The fitted focal lengths are " << camera.fx << " and " << camera.fy
      << " pixels, but both must be positive: the picture is mirrored or turned against the point coordinates." << cure;
    fail(CloudFault::NoProjection, m);
  }
}
}  // namespace

void InputParameters::visit(ParameterVisitor& v)
{
  v.field({"x_min", "m", "points further left in the camera frame are ignored", -100, 100}, x_min);
  v.field({"x_max", "m", "points further right in the camera frame are ignored", -100, 100}, x_max);
  v.field({"y_min", "m", "points further up in the camera frame are ignored", -100, 100}, y_min);
  v.field({"y_max", "m", "points further down in the camera frame are ignored", -100, 100}, y_max);
  v.field({"z_min", "m", "points nearer to the camera are ignored", 0, 100}, z_min);
  v.field({"z_max", "m", "points further from the camera are ignored", 0, 100}, z_max);
  v.field(
      {"bin_floor_margin", "m", "points lower above the bin's floor are ignored; larger hides flat parts", -0.1, 0.5},
      bin_floor_margin);
  v.field({"bin_wall_margin", "m", "points nearer to a wall of the bin are ignored; larger hides parts at the wall",
           -0.1, 0.5},
          bin_wall_margin);
  v.field({"max_plausible_depth", "m", "a larger median depth is refused as not being in metres", 0.1, 1000},
          max_plausible_depth);
  v.field({"max_projection_error", "px", "a cloud whose points miss their pixel's ray by more (median) is refused",
           0.01, 100},
          max_projection_error);
  v.field({"empty_bin_points", "", "fewer measured points than this in the region mean that the bin is empty", 1, 1e6},
          empty_bin_points);
  v.field(
      {"empty_bin_wall_margin", "m",
       "points nearer to a wall of the bin may be the wall: they are searched (but see bin_wall_margin), and do not "
       "count as its content; larger calls a bin empty that holds thin parts at its walls",
       0, 0.5},
      empty_bin_wall_margin);
  v.field({"empty_bin_floor_share", "",
           "of the bin's floor (without a bin, of the picture) that must be measured to call it empty; smaller for a "
           "floor that the sensor does not measure, and then a covered sensor passes for an empty bin",
           0, 1},
          empty_bin_floor_share);
}

PointView viewOf(const pcl::PointCloud<pcl::PointXYZ>& cloud, const InputParameters& parameters)
{
  requireOrganized(cloud);
  PointView points;
  points.width = static_cast<int>(cloud.width);
  points.height = static_cast<int>(cloud.height);
  points.x = &cloud.points.front().x;
  points.y = &cloud.points.front().y;
  points.z = &cloud.points.front().z;
  points.step = sizeof(pcl::PointXYZ) / sizeof(float);
  requireMeasurementsInMetres(points, parameters);
  double error = 0;
  points.camera = fitPinholeCamera(points, error);
  requirePinhole(points.camera, error, parameters);
  return points;
}

DepthGrid makeGrid(const pcl::PointCloud<pcl::PointXYZ>& cloud, const InputParameters& parameters)
{
  return copyMeasured(viewOf(cloud, parameters));
}
}  // namespace bin_picking
