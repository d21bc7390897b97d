// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>

namespace bin_picking
{
/// PNG or JPEG by the file's ending. \throws FileError cannot be written
void writePicture(const cv::Mat& picture, const std::string& path);
}  // namespace bin_picking
