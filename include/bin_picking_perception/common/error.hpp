// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <stdexcept>
#include <string>

namespace bin_picking
{
/// Base of everything that the core throws. what() is a whole sentence: the value, the allowed range, the cure.
/// "Nothing found" is never an exception: it is an ordinary result with a reason.
class Error : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/// A parameter is unknown, mistyped or out of its range.
class ParameterError : public Error
{
public:
  using Error::Error;
};

/// A file is missing, unreadable, damaged, of another version, or its content cannot be used (mesh, part.yaml, ...).
class FileError : public Error
{
public:
  using Error::Error;
};

/// A trained model file is missing, damaged, of another version, or made from another mesh or other parameters.
/// Always curable by training again.
class ModelFileError : public FileError
{
public:
  using FileError::FileError;
};

/// Why a point cloud cannot be used.
enum class CloudFault
{
  Empty,        ///< no points at all
  Unorganized,  ///< height 1: the pixel grid of the sensor is lost
  AllInvalid,   ///< no finite point other than (0, 0, 0)
  BadLayout,    ///< fields missing, wrong data type, truncated data
  UnitSuspect,  ///< looks like millimetres
  NoProjection  ///< the points do not lie on one pinhole camera's rays
};

class CloudError : public Error
{
public:
  CloudError(CloudFault fault, const std::string& message) : Error(message), fault_(fault) {}
  CloudFault fault() const { return fault_; }

private:
  CloudFault fault_;
};
}  // namespace bin_picking
