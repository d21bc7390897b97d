// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "pick_memory.hpp"

#include <gtest/gtest.h>

#include "return_code.hpp"

namespace
{
using namespace bin_picking_ros;
using bin_picking_perception::ReportPick;

const Eigen::Vector3d HERE(0.1, 0, 0.02);
const Eigen::Vector3d THERE(-0.1, 0, 0.02);

bin_picking::AvoidParameters someParameters()
{
  bin_picking::AvoidParameters parameters;
  parameters.duration = 100;
  return parameters;
}

/// Two grasps, one of a part here and one of a part there, as the node names them.
std::string give(PickMemory& memory, PickMemory::Channel channel = PickMemory::Channel::Service)
{
  const std::string answer = memory.nextAnswer();
  memory.remember({{answer + "-0", "tee", "top", HERE}, {answer + "-1", "tee", "side", THERE}}, channel);
  return answer;
}

ReportPick::Request report(const std::string& uid, std::uint8_t outcome)
{
  ReportPick::Request request;
  request.grasp_uid = uid;
  request.outcome = outcome;
  return request;
}

std::int16_t codeOf(PickMemory& memory, const ReportPick::Request& request, std::string* message = nullptr)
{
  try
  {
    memory.report(request, 10);
  }
  catch (const RequestError& error)
  {
    if (message)
      *message = error.what();
    return error.code();
  }
  return ReturnCode::OK;
}

TEST(PickMemory, NamesDifferWithinARunAndBetweenRuns)
{
  PickMemory memory(someParameters(), 3, "ab12");
  PickMemory other(someParameters(), 3, "ab13");
  const std::string first = memory.nextAnswer();
  EXPECT_NE(first, memory.nextAnswer());
  EXPECT_NE(first, other.nextAnswer());
}

TEST(PickMemory, AFailureMakesItsPartAvoidedAndNoOther)
{
  PickMemory memory(someParameters(), 3, "run");
  const std::string answer = give(memory);
  EXPECT_EQ(memory.report(report(answer + "-0", ReportPick::Request::MISSED), 10).grasp_id, "top");
  const auto avoided = memory.avoided({HERE, THERE}, 11);
  ASSERT_TRUE(avoided[0]);
  EXPECT_FALSE(avoided[1]);
  EXPECT_EQ(avoided[0]->outcome, bin_picking::PickOutcome::Missed);
  EXPECT_EQ(memory.places(11).size(), 1u);
  EXPECT_TRUE(memory.places(110).empty()) << "its time is up";
}

TEST(PickMemory, EveryOutcomeIsKnownAndNoOther)
{
  PickMemory memory(someParameters(), 3, "run");
  using Request = ReportPick::Request;
  for (const std::uint8_t outcome :
       {Request::PICKED, Request::MISSED, Request::DROPPED, Request::COLLISION, Request::NOT_ATTEMPTED})
    EXPECT_EQ(codeOf(memory, report(give(memory) + "-0", outcome)), ReturnCode::OK) << int(outcome);
  std::string message;
  EXPECT_EQ(codeOf(memory, report(give(memory) + "-0", 5), &message), ReturnCode::INVALID_ARGUMENT);
  EXPECT_NE(message.find("NOT_ATTEMPTED (4)"), std::string::npos) << message;
}

TEST(PickMemory, AGraspIsReportedOnce)
{
  PickMemory memory(someParameters(), 3, "run");
  const std::string answer = give(memory);
  EXPECT_EQ(codeOf(memory, report(answer + "-0", ReportPick::Request::COLLISION)), ReturnCode::OK);
  std::string message;
  EXPECT_EQ(codeOf(memory, report(answer + "-0", ReportPick::Request::PICKED), &message), ReturnCode::GRASP_UNKNOWN);
  EXPECT_NE(message.find("collision"), std::string::npos) << message;
  EXPECT_EQ(memory.places(10).size(), 1u) << "the second report has cleared nothing";
  EXPECT_EQ(codeOf(memory, report(answer + "-1", ReportPick::Request::PICKED)), ReturnCode::OK);
}

TEST(PickMemory, ForgetsOldAnswersAndKnowsNoStrangers)
{
  PickMemory memory(someParameters(), 3, "run");
  const std::string oldest = give(memory);
  const std::string second = give(memory);
  give(memory);
  give(memory);
  EXPECT_EQ(codeOf(memory, report(oldest + "-0", ReportPick::Request::PICKED)), ReturnCode::GRASP_UNKNOWN);
  EXPECT_EQ(codeOf(memory, report(second + "-0", ReportPick::Request::PICKED)), ReturnCode::OK);
  for (const char* stranger : {"", "run", "run-1", "other-2-0", "run-2-7"})
    EXPECT_EQ(codeOf(memory, report(stranger, ReportPick::Request::PICKED)), ReturnCode::GRASP_UNKNOWN) << stranger;
}

TEST(PickMemory, NeitherEmptyAnswersNorTheTopicPushOutAnAnswer)
{
  PickMemory memory(someParameters(), 3, "run");
  const std::string answer = give(memory);
  for (int i = 0; i < 20; ++i)
  {
    memory.remember({}, PickMemory::Channel::Service);
    give(memory, PickMemory::Channel::Topic);
  }
  const std::string published = give(memory, PickMemory::Channel::Topic);
  EXPECT_EQ(codeOf(memory, report(answer + "-0", ReportPick::Request::PICKED)), ReturnCode::OK);
  EXPECT_EQ(codeOf(memory, report(published + "-1", ReportPick::Request::PICKED)), ReturnCode::OK);
}

TEST(PickMemory, ClearingForgetsThePlaces)
{
  PickMemory memory(someParameters(), 3, "run");
  memory.report(report(give(memory) + "-0", ReportPick::Request::DROPPED), 10);
  EXPECT_EQ(memory.clear(11), 1u);
  EXPECT_FALSE(memory.avoided({HERE}, 11)[0]);
}
}  // namespace
