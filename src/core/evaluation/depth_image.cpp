// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <opencv2/imgcodecs.hpp>

#include "bin_picking_perception/common/error.hpp"
#include "dataset_readers.hpp"

namespace bin_picking
{
namespace
{
cv::Mat readPicture(const std::string& path)
{
  cv::Mat picture;
  try
  {
    picture = cv::imread(path, cv::IMREAD_UNCHANGED);
  }
  catch (const cv::Exception&)
  {
    picture.release();  // the same as what OpenCV answers for other kinds of damage
  }
  if (picture.empty())
    throw FileError("The picture " + path + " is missing, damaged or of an unknown kind; get the data set again.");
  return picture;
}

std::string sizeText(const cv::Mat& picture)
{
  return std::to_string(picture.cols) + " x " + std::to_string(picture.rows);
}

void requireFit(const cv::Mat& depth, const std::string& path, const DepthImageFormat& format)
{
  if (depth.type() != CV_16UC1)
    throw FileError("The depth picture " + path +
                    " does not have one channel of 16 bits; save it as 16-bit PNG or TIFF.");
  const PinholeCamera& c = format.camera;
  if (c.cx < 0 || c.cy < 0 || c.cx > depth.cols || c.cy > depth.rows)
    throw FileError("The depth picture " + path + " has " + sizeText(depth) +
                    " pixels, but the middle of its camera is " + std::to_string(c.cx) + ", " + std::to_string(c.cy) +
                    ": picture and camera do not belong together.");
  if (format.color_image.empty())
    return;
  const cv::Mat color = readPicture(format.color_image);
  if (color.size() != depth.size())
    throw FileError("The depth picture " + path + " has " + sizeText(depth) + " pixels, but " + format.color_image +
                    " has " + sizeText(color) + "; both must come from one camera. Get the data set again.");
}
}  // namespace

DepthGrid loadDepthImage(const std::string& path, const DepthImageFormat& format)
{
  const cv::Mat depth = readPicture(path);
  requireFit(depth, path, format);
  DepthGrid grid = makeGrid(depth.cols, depth.rows, format.camera);
  for (int v = 0; v < depth.rows; ++v)
    for (int u = 0; u < depth.cols; ++u)
    {
      const std::uint16_t raw = depth.at<std::uint16_t>(v, u);
      if (raw == 0)
        continue;
      const Eigen::Vector3f p = format.camera.backProject(u, v, raw * format.step).cast<float>();
      const auto i = static_cast<std::size_t>(grid.index(u, v));
      grid.x[i] = p.x();
      grid.y[i] = p.y();
      grid.z[i] = p.z();
    }
  return grid;
}
}  // namespace bin_picking
