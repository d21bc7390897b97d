// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <bin_picking_perception/ReturnCode.h>

#include <cstdint>
#include <exception>
#include <stdexcept>
#include <string>

namespace bin_picking_ros
{
using bin_picking_perception::ReturnCode;

/// A request that cannot be answered. what() is a sentence with the numbers.
class RequestError : public std::runtime_error
{
public:
  RequestError(std::int16_t code, const std::string& message) : std::runtime_error(message), code_(code) {}
  std::int16_t code() const { return code_; }

private:
  std::int16_t code_;
};

/// The message with the code's name and the hint that belongs to it. \throws std::logic_error for an unknown code
ReturnCode makeReturnCode(std::int16_t value, const std::string& message);

/// The one place where exceptions become codes: RequestError, and the typed errors of the core; everything else is
/// INTERNAL.
ReturnCode translateException(const std::exception_ptr& exception);

/// The outcome, of a response's own, of a request that was not carried out: not ready, an error of ours, or else a
/// request whose poses, frames, parts or widths cannot be.
template <typename Response>
std::int8_t outcomeOfFailure(const ReturnCode& code)
{
  switch (code.value)
  {
    case ReturnCode::NOT_READY:
      return Response::NOT_READY;
    case ReturnCode::INTERNAL:
      return Response::FAILED;
    default:
      return Response::INVALID_REQUEST;
  }
}
}  // namespace bin_picking_ros
