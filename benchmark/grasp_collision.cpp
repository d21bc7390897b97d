// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// The collision check of grasps against the truth of simulated bins: what it lets pass wrongly, what it refuses without
// need, and how long it takes.
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <map>
#include <string>

#include "bin_picking_perception/common/error.hpp"
#include "core/bin_of_grasps.hpp"

namespace
{
using namespace bin_picking;

/// Of the processor, so that other programs on the machine do not count.
double processorMicroseconds()
{
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return 1e6 * static_cast<double>(time.tv_sec) + 1e-3 * static_cast<double>(time.tv_nsec);
}

constexpr const char* STAGES[] = {"approach", "closing", "retreat"};

struct Tally
{
  int not_judged = 0;
  int tried = 0;
  int truly_free = 0;
  int called_free = 0;
  int both_free = 0;
  std::vector<double> false_free;         ///< true depths, metres
  std::map<std::string, int> blocked_by;  ///< truly free, refused
};

/// The bin and what a held part drags along are not part of the truth: what they refuse does not count.
void add(Tally& tally, const Clearance& clearance, double depth)
{
  if (!clearance.free() && (clearance.kind == ObstacleKind::BinFloor || clearance.kind == ObstacleKind::BinWall ||
                            clearance.body == HELD_PART))
  {
    ++tally.not_judged;
    return;
  }
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
  std::printf("%-9s tried %6d  truly free %6d  called free %6d  both %6d (%.1f %% of truly free)\n", name, t.tried,
              t.truly_free, t.called_free, t.both_free, 100.0 * t.both_free / std::max(1, t.truly_free));
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
  std::printf("\n          refused by bin or held part, not judged: %d\n", t.not_judged);
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

constexpr char HELP[] =
    "usage: benchmark_grasp_collision [--bins N] [--grasps N] [--parts N] [--gripper NAME] [--part NAME]...\n"
    "                                 [--forgotten SHARE] [--set KEY=VALUE]...\n\n"
    "Random grasps in simulated bins: the collision check against the true meshes of all parts.\n\n"
    "options:\n"
    "  --bins N           bins of each part (default 10)\n"
    "  --grasps N         grasps in each bin (default 500)\n"
    "  --parts N          parts in a bin (default 25)\n"
    "  --gripper NAME     of config/grippers (default ag95)\n"
    "  --part NAME        of config/parts (default three_way_tube, l_bracket, stepped_shaft)\n"
    "  --forgotten SHARE  of the parts that are seen but not known to the check (default 0.3)\n"
    "  --set KEY=VALUE    parameters of the check: unseen_entry=0.004, ...\n";

Options parse(int count, char** words)
{
  Options options;
  for (int i = 1; i < count; i += 2)
  {
    const std::string name = words[i];
    if (name == "--help" || name == "-h")
    {
      std::fputs(HELP, stdout);
      std::exit(EXIT_SUCCESS);
    }
    if (i + 1 == count)
      throw ParameterError("option " + name + " needs a value");
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

/// Stage by stage, up to the first that is not free.
std::vector<Clearance> check(const Obstacles& obstacles, const Gripper& gripper, const test::TriedGrasp& grasp)
{
  std::vector<Clearance> verdicts = {obstacles.approach(gripper, grasp.approach, grasp.target)};
  if (verdicts.back().free())
    verdicts.push_back(obstacles.closing(gripper, grasp.retreat.T_camera_tool0, grasp.approach.opening,
                                         grasp.retreat.opening, grasp.target));
  if (verdicts.size() == 2 && verdicts.back().free())
    verdicts.push_back(obstacles.retreat(gripper, grasp.retreat, grasp.target));
  return verdicts;
}

double trueDepth(std::size_t stage, const test::BinOfGrasps& bin, const Gripper& gripper, const test::TriedGrasp& grasp)
{
  if (stage == 0)
    return test::trueApproachDepth(bin, gripper, grasp);
  return stage == 1 ? test::trueClosingDepth(bin, gripper, grasp) : test::trueRetreatDepth(bin, gripper, grasp);
}

void run(const Options& options)
{
  const std::string config = BIN_PICKING_SOURCE_DIR "/config/";
  const Gripper gripper = loadGripper(config + "grippers/" + options.gripper + ".yaml");
  Tally tallies[3];
  double construction_us = 0;
  double checks_us = 0;
  int checked = 0;
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
      const Executor executor(1);
      double fastest = 1e9;
      for (int k = 0; k < 5; ++k)
      {
        const double begin = processorMicroseconds();
        const Obstacles timed(&bin.measured, &bin.bin, bin.placed, options.parameters, executor);
        fastest = std::min(fastest, processorMicroseconds() - begin);
      }
      construction_us += fastest;
      const Obstacles obstacles(&bin.measured, &bin.bin, bin.placed, options.parameters, executor);
      std::vector<test::TriedGrasp> grasps;
      for (int i = 0; i < options.grasps; ++i)
        grasps.push_back(bin.randomGrasp(gripper));
      // All together: reading the clock takes as long as a check.
      std::vector<std::vector<Clearance>> verdicts;
      const double checks_begin = processorMicroseconds();
      for (const test::TriedGrasp& grasp : grasps)
        verdicts.push_back(check(obstacles, gripper, grasp));
      checks_us += processorMicroseconds() - checks_begin;
      checked += options.grasps;
      for (std::size_t i = 0; i < grasps.size(); ++i)
        for (std::size_t stage = 0; stage < verdicts[i].size(); ++stage)
          add(tallies[stage], verdicts[i][stage], trueDepth(stage, bin, gripper, grasps[i]));
    }
  }
  for (int stage = 0; stage < 3; ++stage)
    print(STAGES[stage], tallies[stage]);
  const double bins = static_cast<double>(options.bins) * static_cast<double>(options.kinds.size());
  std::printf("construction %.0f us, checks of a grasp %.1f us, of one processor\n", construction_us / bins,
              checks_us / std::max(1, checked));
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
