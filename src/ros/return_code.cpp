// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "return_code.hpp"

#include <array>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking_ros
{
namespace
{
struct CodeText
{
  std::int16_t value;
  const char* name;
  const char* hint;
};

constexpr std::array<CodeText, 21> CODES = {{
    {ReturnCode::OK, "OK", ""},
    {ReturnCode::PARTIAL, "PARTIAL", "Allow a longer deadline, or choose the preset fast."},
    {ReturnCode::BIN_EMPTY, "BIN_EMPTY",
     "Bring the next bin; if parts are left, check the bin's pose and size and what the sensor measures of the parts."},
    {ReturnCode::NO_MATCH, "NO_MATCH",
     "Stir the bin or move the camera; look at the rejected detections for what was close."},
    {ReturnCode::NO_PICKABLE, "NO_PICKABLE", "Stir the bin; see the summary of reasons, and add grasps to part.yaml."},
    {ReturnCode::ALL_AVOIDED, "ALL_AVOIDED",
     "Call again later, or ~clear_avoid_list to try these parts again; stir the bin if they fail again."},
    {ReturnCode::INVALID_ARGUMENT, "INVALID_ARGUMENT", "Correct the request."},
    {ReturnCode::INTERNAL, "INTERNAL", "Look at the log of the node for the first error."},
    {ReturnCode::DEADLINE, "DEADLINE", "Allow a longer deadline, or choose the preset fast."},
    {ReturnCode::NO_CLOUD, "NO_CLOUD",
     "Check that the camera runs and that the topic points is remapped to its cloud."},
    {ReturnCode::STALE_CLOUD, "STALE_CLOUD", "Trigger the camera, raise max_age, or synchronise the clocks."},
    {ReturnCode::BAD_CLOUD, "BAD_CLOUD",
     "Let the driver publish an organized cloud with x, y, z as float32 in metres; check projector, exposure and "
     "view."},
    {ReturnCode::NOT_READY, "NOT_READY", "Call again; training a part for the first time takes a while."},
    {ReturnCode::TF_UNKNOWN_FRAME, "TF_UNKNOWN_FRAME", "Check the frame's spelling and who publishes it."},
    {ReturnCode::TF_EXTRAPOLATION, "TF_EXTRAPOLATION",
     "Synchronise the clocks of camera and robot, or raise tf_timeout."},
    {ReturnCode::TF_DISCONNECTED, "TF_DISCONNECTED",
     "Publish the transform between robot and camera (hand-eye calibration)."},
    {ReturnCode::UNIT_SUSPECT, "UNIT_SUSPECT", "Let the driver publish metres (REP 103)."},
    {ReturnCode::PART_UNKNOWN, "PART_UNKNOWN", "Add the part's directory to the parameter ~parts."},
    {ReturnCode::GRIPPER_UNKNOWN, "GRIPPER_UNKNOWN", "Add the gripper's file to the parameter ~grippers."},
    {ReturnCode::GRASP_UNKNOWN, "GRASP_UNKNOWN",
     "Report the uid of a grasp of a recent answer, once; raise ~remembered_answers if it was forgotten."},
    {ReturnCode::BAD_TRANSFORM, "BAD_TRANSFORM",
     "Correct who publishes the transform: a unit quaternion, finite numbers, one parent for each frame."},
}};

std::int16_t codeOf(bin_picking::CloudFault fault)
{
  return fault == bin_picking::CloudFault::UnitSuspect ? ReturnCode::UNIT_SUSPECT : ReturnCode::BAD_CLOUD;
}
}  // namespace

ReturnCode makeReturnCode(std::int16_t value, const std::string& message)
{
  for (const CodeText& text : CODES)
  {
    if (text.value != value)
      continue;
    ReturnCode code;
    code.value = value;
    code.name = text.name;
    code.message = message;
    code.hint = text.hint;
    return code;
  }
  throw std::logic_error("There is no return code " + std::to_string(value) + ".");
}

ReturnCode translateException(const std::exception_ptr& exception)
{
  try
  {
    std::rethrow_exception(exception);
  }
  catch (const RequestError& error)
  {
    return makeReturnCode(error.code(), error.what());
  }
  catch (const bin_picking::CloudError& error)
  {
    return makeReturnCode(codeOf(error.fault()), error.what());
  }
  catch (const bin_picking::ParameterError& error)
  {
    return makeReturnCode(ReturnCode::INVALID_ARGUMENT, error.what());
  }
  catch (const std::exception& error)
  {
    return makeReturnCode(ReturnCode::INTERNAL, error.what());
  }
  catch (...)
  {
    return makeReturnCode(ReturnCode::INTERNAL, "Something was thrown that is not an exception.");
  }
}
}  // namespace bin_picking_ros
