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
}  // namespace bin_picking_ros
