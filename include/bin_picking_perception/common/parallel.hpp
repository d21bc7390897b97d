// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>

namespace bin_picking
{
/// A bounded set of threads. The results of a computation must not depend on its size: tasks write to their own slot,
/// and whoever joins the slots does so in task order.
class Executor
{
public:
  /// \param num_threads at most so many, and no more than there are processors; 0 means all processors.
  explicit Executor(int num_threads = 1);
  ~Executor();
  Executor(Executor&&) noexcept;
  Executor& operator=(Executor&&) noexcept;

  /// Calls task(0) ... task(num_tasks - 1), in any order and possibly at once; returns when all are done. An exception
  /// of a task reaches the caller. Safe to call from several threads.
  void forEach(std::size_t num_tasks, const std::function<void(std::size_t)>& task) const;

  /// Runs task(begin, end) for [0, count) in pieces of `size`: for many short tasks of a known cost.
  void forEachBundle(std::size_t count, std::size_t size,
                     const std::function<void(std::size_t, std::size_t)>& task) const
  {
    forEach((count + size - 1) / size, [&](std::size_t b) { task(b * size, std::min(count, (b + 1) * size)); });
  }

  int numThreads() const { return num_threads_; }

private:
  struct Arena;
  int num_threads_;
  std::unique_ptr<Arena> arena_;
};
}  // namespace bin_picking
