// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "cell_requests.hpp"

#include <cmath>
#include <string>

#include "return_code.hpp"

namespace bin_picking_ros
{
void checkRequest(const bin_picking_perception::TakePart::Request& request)
{
  using Request = bin_picking_perception::TakePart::Request;
  if (request.select != Request::BY_ID && request.select != Request::BY_POSE)
    throw RequestError(ReturnCode::INVALID_ARGUMENT,
                       "select is " + std::to_string(request.select) + "; it must be BY_ID (0) or BY_POSE (1).");
  if (!std::isfinite(request.tolerance) || request.tolerance < 0)
    throw RequestError(ReturnCode::INVALID_ARGUMENT, "tolerance is " + std::to_string(request.tolerance) +
                                                         " m; it must not be negative; 0 means the parameter.");
}

void checkRequest(const bin_picking_perception::Grip::Request& request)
{
  if (!std::isfinite(request.opening) || !std::isfinite(request.width))
    throw RequestError(ReturnCode::INVALID_ARGUMENT, "opening is " + std::to_string(request.opening) + " m and width " +
                                                         std::to_string(request.width) + " m; both must be finite.");
}
}  // namespace bin_picking_ros
