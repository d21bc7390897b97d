// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/common/parallel.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <thread>

namespace bin_picking
{
struct Executor::Arena
{
  explicit Arena(int num_threads) : arena(num_threads) {}
  tbb::task_arena arena;
};

namespace
{
/// More threads than processors only wait for each other.
int boundedThreads(int wanted)
{
  const int processors = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  return wanted > 0 ? std::min(wanted, processors) : processors;
}
}  // namespace

Executor::Executor(int num_threads) : num_threads_(boundedThreads(num_threads))
{
  if (num_threads_ > 1)
    arena_ = std::make_unique<Arena>(num_threads_);
}

Executor::~Executor() = default;
Executor::Executor(Executor&&) noexcept = default;
Executor& Executor::operator=(Executor&&) noexcept = default;

void Executor::forEach(std::size_t num_tasks, const std::function<void(std::size_t)>& task) const
{
  if (!arena_ || num_tasks < 2)
  {
    for (std::size_t i = 0; i < num_tasks; ++i)
      task(i);
    return;
  }
  arena_->arena.execute([&] {
    tbb::parallel_for(
        tbb::blocked_range<std::size_t>(0, num_tasks, 1),
        [&](const tbb::blocked_range<std::size_t>& range) {
          for (std::size_t i = range.begin(); i != range.end(); ++i)
            task(i);
        },
        tbb::simple_partitioner());
  });
}
}  // namespace bin_picking
