// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// The collision check of grasps against the truth of simulated bins: what it lets pass wrongly, what it refuses without
// need, and how long it takes.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <map>
#include <string>

#include "core/bin_of_grasps.hpp"

namespace
{
using namespace bin_picking;
using Clock = std::chrono::steady_clock;

double microseconds(Clock::time_point begin)
{
  return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
}

constexpr const char* STAGES[] = {"approach", "closing", "retreat"};

struct Tally
{
  int tried = 0;
  int truly_free = 0;
  int called_free = 0;
  int both_free = 0;
  std::vector<double> false_free;         ///< true depths, metres
  std::map<std::string, int> blocked_by;  ///< truly free, refused
  double check_us = 0;
  int checks = 0;
};

/// The bin is not part of the truth: what it refuses does not count.
void add(Tally& tally, const Clearance& clearance, double depth, double us)
{
  tally.check_us += us;
  ++tally.checks;
  if (!clearance.free() && (clearance.kind == ObstacleKind::BinFloor || clearance.kind == ObstacleKind::BinWall))
    return;
  ++tally.tried;
  tally.truly_free += depth == 0;
  tally.called_free += clearance.free();
  tally.both_free += clearance.free() && depth == 0;
  if (clearance.free() && depth > 0)
    tally.false_free.push_back(depth);
  if (!clearance.free() && depth == 0)
    ++tally.blocked_by[toString(clearance.kind)];
}

void print(const char* name, const Tally& t)
{
  std::printf("%-9s tried %6d  truly free %6d  called free %6d  both %6d (%.1f %% of truly free)  %.1f us a check\n",
              name, t.tried, t.truly_free, t.called_free, t.both_free, 100.0 * t.both_free / std::max(1, t.truly_free),
              t.check_us / std::max(1, t.checks));
  const double edges[] = {0, 0.0002, 0.0005, 0.001, 0.002, 0.003, 0.005, 0.1};
  std::printf("          falsely free, by true depth (mm):");
  for (int k = 0; k < 7; ++k)
  {
    int count = 0;
    for (const double depth : t.false_free)
      count += depth > edges[k] && depth <= edges[k + 1];
    std::printf("  %g-%g: %d", 1e3 * edges[k], 1e3 * edges[k + 1], count);
  }
  std::printf("\n          refused without need:");
  for (const auto& [kind, count] : t.blocked_by)
    std::printf("  %s %d", kind.c_str(), count);
  std::printf("\n");
}

struct Options
{
  int bins = 10;
  int grasps = 500;
  int parts = 25;
  std::string gripper = "ag95";
  std::vector<std::string> kinds;
  ObstacleParameters parameters;
  test::BinTrouble trouble;
};

Options parse(int count, char** words)
{
  Options options;
  for (int i = 1; i + 1 < count; i += 2)
  {
    const std::string name = words[i];
    const std::string value = words[i + 1];
    if (name == "--bins")
      options.bins = std::stoi(value);
    else if (name == "--grasps")
      options.grasps = std::stoi(value);
    else if (name == "--parts")
      options.parts = std::stoi(value);
    else if (name == "--gripper")
      options.gripper = value;
    else if (name == "--part")
      options.kinds.push_back(value);
    else if (name == "--forgotten")
      options.trouble.forgotten_share = std::stod(value);
    else if (name == "--set")
      setParameter(visitor(options.parameters), value);
    else
      throw ParameterError("unknown option " + name +
                           "; known are --bins, --grasps, --parts, --gripper, --part, --forgotten, --set");
  }
  if (options.kinds.empty())
    options.kinds = {"three_way_tube", "l_bracket", "stepped_shaft"};
  return options;
}

void run(const Options& options)
{
  const std::string config = BIN_PICKING_SOURCE_DIR "/config/";
  const Gripper gripper = loadGripper(config + "grippers/" + options.gripper + ".yaml");
  Tally tallies[3];
  Tally all;
  double construction_us = 0;
  double worst_us = 0;
  for (const std::string& name : options.kinds)
  {
    test::BinOfGrasps::Kind kind;
    kind.definition = loadPart(config + "parts/" + name);
    kind.model = trainPart(kind.definition, {}, Executor(2));
    for (int seed = 1; seed <= options.bins; ++seed)
    {
      test::BinOfGrasps bin({kind}, {options.parts}, static_cast<std::uint32_t>(seed), simulation::CellParameters(),
                            options.trouble);
      if (bin.placed.empty())
        continue;
      const Executor executor(2);
      double fastest = 1e9;
      for (int k = 0; k < 3; ++k)
      {
        const auto begin = Clock::now();
        const Obstacles timed(&bin.measured, &bin.bin, bin.placed, options.parameters, executor);
        fastest = std::min(fastest, microseconds(begin));
      }
      construction_us += fastest;
      const Obstacles obstacles(&bin.measured, &bin.bin, bin.placed, options.parameters, executor);
      for (int i = 0; i < options.grasps; ++i)
      {
        const test::TriedGrasp grasp = bin.randomGrasp(gripper);
        bool free = true;
        double deepest = 0;
        double grasp_us = 0;
        Clearance last;
        for (int stage = 0; stage < 3 && free; ++stage)
        {
          const auto begin = Clock::now();
          last = stage == 0   ? obstacles.approach(gripper, grasp.approach, grasp.target)
                 : stage == 1 ? obstacles.closing(gripper, grasp.retreat.T_camera_tool0, grasp.approach.opening,
                                                  grasp.retreat.opening, grasp.target)
                              : obstacles.retreat(gripper, grasp.retreat, grasp.target);
          const double us = microseconds(begin);
          grasp_us += us;
          const double depth = stage == 0   ? test::trueApproachDepth(bin, gripper, grasp)
                               : stage == 1 ? test::trueClosingDepth(bin, gripper, grasp)
                                            : test::trueRetreatDepth(bin, gripper, grasp);
          add(tallies[stage], last, depth, us);
          deepest = std::max(deepest, depth);
          free = last.free();
        }
        worst_us = std::max(worst_us, grasp_us);
        all.check_us += grasp_us;
        ++all.checks;
      }
    }
  }
  for (int stage = 0; stage < 3; ++stage)
    print(STAGES[stage], tallies[stage]);
  const double bins = static_cast<double>(options.bins) * static_cast<double>(options.kinds.size());
  std::printf("construction %.0f us, a grasp %.1f us on average, %.0f us at most\n", construction_us / bins,
              all.check_us / std::max(1, all.checks), worst_us);
}
}  // namespace

int main(int count, char** words)
{
  try
  {
    run(parse(count, words));
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
