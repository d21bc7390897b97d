// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "child_process.hpp"

#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <exception>
#include <iostream>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking::peers
{
namespace
{
constexpr char ERROR_MARK = '!';  // first character of the line that tells an exception

void writeLine(int pipe, const std::string& line)
{
  const std::string text = line + "\n";
  for (std::size_t done = 0; done < text.size();)
  {
    const ssize_t count = write(pipe, text.data() + done, text.size() - done);
    if (count < 0 && errno != EINTR)
      _exit(2);  // nobody listens any more
    done += count > 0 ? static_cast<std::size_t>(count) : 0;
  }
}

[[noreturn]] void runTask(const std::function<void(const LineSink&)>& task, int pipe)
{
  try
  {
    task([&](const std::string& line) { writeLine(pipe, line); });
  }
  catch (const std::exception& error)
  {
    writeLine(pipe, ERROR_MARK + std::string(error.what()));
  }
  _exit(0);  // without the parent's exit handlers
}

double cpuSecondsOf(pid_t process)
{
  clockid_t clock{};
  timespec used{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &used) != 0)
    return 0;  // it has ended: its pipe will say so
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

/// How long ago the last line came.
class Patience
{
public:
  Patience(pid_t process, double seconds) : process_(process), seconds_(seconds) { restart(); }
  void restart()
  {
    cpu_start_ = cpuSecondsOf(process_);
    start_ = Clock::now();
  }
  bool exhausted() const
  {
    constexpr double CLOCK_FACTOR = 10;
    return cpuSecondsOf(process_) - cpu_start_ > seconds_ ||
           std::chrono::duration<double>(Clock::now() - start_).count() > CLOCK_FACTOR * seconds_;
  }

private:
  using Clock = std::chrono::steady_clock;
  pid_t process_;
  double seconds_;
  double cpu_start_ = 0;
  Clock::time_point start_;
};

/// Lines until the other end closes. \return why it was given up, or what the task has thrown; else empty
std::string readLines(int pipe, pid_t child, double seconds_per_line, const LineSink& receive)
{
  constexpr int POLL_MS = 200;
  Patience patience(child, seconds_per_line);
  std::string pending;
  std::array<char, 4096> buffer{};
  while (true)
  {
    pollfd waiting{pipe, POLLIN, 0};
    const int ready = poll(&waiting, 1, POLL_MS);
    if (ready < 0 && errno == EINTR)
      continue;
    if (patience.exhausted())
      return "no result within " + std::to_string(static_cast<int>(seconds_per_line)) + " s";
    if (ready == 0)
      continue;
    const ssize_t count = read(pipe, buffer.data(), buffer.size());
    if (count <= 0)
      return "";
    pending.append(buffer.data(), static_cast<std::size_t>(count));
    for (std::size_t end = pending.find('\n'); end != std::string::npos; end = pending.find('\n'))
    {
      const std::string line = pending.substr(0, end);
      pending.erase(0, end + 1);
      if (!line.empty() && line.front() == ERROR_MARK)
        return line.substr(1);
      receive(line);
      patience.restart();
    }
  }
}
}  // namespace

std::string runInChild(const std::function<void(const LineSink& emit)>& task, double seconds_per_line,
                       const LineSink& receive)
{
  std::array<int, 2> ends{};
  std::cout.flush();
  if (pipe(ends.data()) != 0)
    throw Error(std::string("cannot open a pipe to another process: ") + std::strerror(errno));
  const pid_t child = fork();
  if (child < 0)
    throw Error(std::string("cannot start another process: ") + std::strerror(errno));
  if (child == 0)
  {
    close(ends[0]);
    runTask(task, ends[1]);
  }
  close(ends[1]);
  const std::string reason = readLines(ends[0], child, seconds_per_line, receive);
  close(ends[0]);
  if (!reason.empty())
    kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  if (!reason.empty())
    return reason;
  return WIFSIGNALED(status) ? std::string("crashed (") + strsignal(WTERMSIG(status)) + ")" : "";
}
}  // namespace bin_picking::peers
