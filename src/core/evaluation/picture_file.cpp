// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/picture_file.hpp"

#include <opencv2/imgcodecs.hpp>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
void writePicture(const cv::Mat& picture, const std::string& path)
{
  bool written = false;
  std::string reason;
  try
  {
    written = cv::imwrite(path, picture);
  }
  catch (const cv::Exception& e)
  {
    reason = " (" + e.err + ")";
  }
  if (!written)
    throw FileError("cannot write the picture '" + path + "'" + reason +
                    "; check that the folder exists, that there is room, and that the name ends in .png or .jpg");
}
}  // namespace bin_picking
