// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "turns.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <optional>
#include <thread>
#include <vector>

namespace
{
using bin_picking_ros::Turns;

Turns::Clock::time_point soon() { return Turns::Clock::now() + std::chrono::milliseconds(20); }
Turns::Clock::time_point late() { return Turns::Clock::now() + std::chrono::minutes(5); }

TEST(Turns, OneAtATime)
{
  Turns turns;
  std::atomic<int> num_inside{0};
  std::atomic<int> most_inside{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&] {
      for (int k = 0; k < 200; ++k)
      {
        const Turns::Turn turn = turns.wait(late());
        ASSERT_TRUE(turn);
        const int inside = ++num_inside;
        int most = most_inside;
        while (inside > most && !most_inside.compare_exchange_weak(most, inside))
          ;
        --num_inside;
      }
    });
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_EQ(most_inside, 1);
}

// Who comes back at once stands behind who waits: a plain mutex would usually be taken again by the same thread.
TEST(Turns, InTheOrderOfAsking)
{
  Turns turns;
  std::optional<Turns::Turn> first(turns.wait(late()));
  std::atomic<bool> asks{false};
  auto waiting = std::async(std::launch::async, [&] {
    asks = true;
    return static_cast<bool>(turns.wait(late()));
  });
  while (!asks)
    std::this_thread::yield();
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // from asking to the queue it is one lock
  first.reset();
  first.emplace(turns.wait(late()));
  EXPECT_EQ(waiting.wait_for(std::chrono::seconds(60)), std::future_status::ready);
  EXPECT_TRUE(waiting.get());
}

TEST(Turns, WhoseTimeIsUpLeavesTheQueue)
{
  Turns turns;
  {
    const Turns::Turn first = turns.wait(late());
    EXPECT_FALSE(turns.wait(soon()));
    EXPECT_FALSE(turns.wait(soon()));
  }
  EXPECT_TRUE(turns.wait(soon())) << "those who left hold up nobody";
}

TEST(Turns, ClosingEndsAllWaiting)
{
  Turns turns;
  const Turns::Turn first = turns.wait(late());
  auto waiting = std::async(std::launch::async, [&] { return static_cast<bool>(turns.wait(late())); });
  turns.close();
  EXPECT_EQ(waiting.wait_for(std::chrono::seconds(60)), std::future_status::ready);
  EXPECT_FALSE(waiting.get());
  EXPECT_FALSE(turns.wait(late()));
}
}  // namespace
