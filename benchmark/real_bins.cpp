// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// Real bins: PVC elbows seen by a stereo camera, with silver poses, and clouds of a cluttered bin without any elbow.
// Usage: benchmark_real_bins DATA_DIR [--images DIR] [--preset NAME] [--leaf LENGTH] [--set parameter=value ...]
// DATA_DIR holds pipes/Pipe_02.stl (mm), pipes/pipes_90_*.pcd with .json, and phoxi_bins/*.pcd.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/evaluation/detection_picture.hpp"
#include "bin_picking_perception/evaluation/pose_error.hpp"

namespace fs = std::filesystem;
using namespace bin_picking;

namespace
{
constexpr double MAX_TRANSLATION = 0.005;
constexpr double MAX_ROTATION = 10 * M_PI / 180;

struct Options
{
  fs::path data;
  fs::path images;
  DetectorParameters parameters;
  TrainingParameters training;
};

Options parse(int argc, char** argv)
{
  if (argc < 2)
    throw ParameterError(
        "usage: benchmark_real_bins DATA_DIR [--images DIR] [--preset NAME] [--leaf LENGTH] [--set parameter=value "
        "...]");
  Options options;
  options.data = argv[1];
  for (int i = 2; i + 1 < argc; i += 2)
  {
    const std::string name = argv[i];
    const std::string value = argv[i + 1];
    if (name == "--images")
      options.images = value;
    else if (name == "--preset")
      options.parameters = DetectorParameters::preset(value);
    else if (name == "--leaf")
      options.training.leaf = parseQuantity(value, "m");
    else if (name == "--train")
      setParameter(visitor(options.training), value);
    else if (name == "--set")
      setParameter(visitor(options.parameters), value);
    else
      throw ParameterError("unknown option " + name);
  }
  return options;
}

/// The elbow equals itself after a half turn that swaps its ends: about the bisector of its two bores.
PartDefinition elbow(const fs::path& mesh)
{
  PartDefinition part;
  part.name = "elbow";
  part.mesh_file = mesh.string();
  part.mesh_unit = LengthUnit::Millimetre;
  const Eigen::Vector3d origin(0.0206, 0, 0);
  Pose swap = Pose::Identity();
  swap.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d(0, 1, 1).normalized()).toRotationMatrix();
  swap.translation() = origin - swap.linear() * origin;
  part.symmetry.discrete.push_back(swap);
  return part;
}

std::vector<Pose> readTruth(const fs::path& file)
{
  std::ifstream in(file);
  const auto json = nlohmann::json::parse(in);
  std::vector<Pose> poses;
  for (const auto& instance : json.at("instances"))
  {
    Pose T;
    for (int r = 0; r < 4; ++r)
      for (int c = 0; c < 4; ++c)
        T.matrix()(r, c) = instance.at("T_camera_object")
                               .at(static_cast<std::size_t>(r))
                               .at(static_cast<std::size_t>(c))
                               .get<double>();
    T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
    poses.push_back(T);
  }
  return poses;
}

std::vector<fs::path> clouds(const fs::path& folder, const std::string& prefix)
{
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".pcd" && entry.path().filename().string().rfind(prefix, 0) == 0)
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

void printScores(const DetectionResult& result)
{
  for (const auto& d : result.detections)
  {
    std::printf("    score %.3f visible %.3f rms %.2f mm", d.score, d.visible_fraction, 1e3 * d.rms);
    for (const auto& criterion : d.criteria)
      if (criterion.name != "score" && criterion.name != "visible_fraction")
        std::printf(" %s %.3f", criterion.name.c_str(), criterion.value);
    std::printf("\n");
  }
}

struct Totals
{
  int listed = 0;
  int found = 0;
};

void report(const fs::path& file, const DetectionResult& result, const TrainedModel& model,
            const std::vector<Pose>& truth, Totals& totals)
{
  std::printf("%s: %zu accepted, %.0f ms\n", file.stem().c_str(), result.detections.size(), 1e3 * result.total_seconds);
  for (const auto& T : truth)
  {
    int rank = -1;
    PoseError best{1e3, 0};
    for (std::size_t i = 0; i < result.detections.size(); ++i)
    {
      const auto error = poseError(result.detections[i].T_camera_object, T, model.symmetry, model.center);
      if (error.translation < best.translation)
      {
        best = error;
        rank = static_cast<int>(i);
      }
    }
    const bool found = best.translation < MAX_TRANSLATION && best.rotation < MAX_ROTATION;
    ++totals.listed;
    totals.found += found;
    std::printf("  listed pose %s, nearest rank %d: %.1f mm, %.1f deg\n", found ? "found" : "MISSED", rank,
                1e3 * best.translation, best.rotation * 180 / M_PI);
  }
}

int run(const Options& options)
{
  const Executor executor(0);
  const auto model = trainPart(elbow(options.data / "pipes" / "Pipe_02.stl"), options.training, executor);
  std::printf("elbow: diameter %.1f mm, leaf %.2f mm, %zu points, %zu pairs, %d curvature bins\n",
              1e3 * model->diameter, 1e3 * model->parameters.leaf, model->points.size(), model->table.numEntries(),
              model->table.quantizer().curvature_bins);
  const Detector detector({model}, options.parameters);
  Totals totals;
  const auto detect = [&](const fs::path& file) {
    const DepthGrid grid = loadGrid(file.string(), options.parameters.input);
    auto result = detector.detect(grid, {});
    if (!options.images.empty())
      saveDetectionPicture(grid, result, {model}, (options.images / (file.stem().string() + ".png")).string());
    return result;
  };
  for (const auto& file : clouds(options.data / "pipes", "pipes_90"))
  {
    const auto result = detect(file);
    report(file, result, *model, readTruth(fs::path(file).replace_extension(".json")), totals);
    printScores(result);
  }
  std::printf("listed silver poses found within 5 mm and 10 deg: %d of %d (%.1f %%)\n", totals.found, totals.listed,
              100.0 * totals.found / totals.listed);
  std::size_t false_ones = 0;
  for (const auto& [folder, prefix] : {std::pair<const char*, const char*>("phoxi_bins", ""), {"pipes", "pipes_180"}})
    for (const auto& file : clouds(options.data / folder, prefix))
    {
      const auto result = detect(file);
      std::printf("%s: %zu accepted, %.0f ms; %s\n", file.stem().c_str(), result.detections.size(),
                  1e3 * result.total_seconds, result.message.c_str());
      printScores(result);
      false_ones += result.detections.size();
    }
  std::printf("elbows accepted where there is none: %zu\n", false_ones);
  return 0;
}
}  // namespace

int main(int argc, char** argv)
{
  try
  {
    return run(parse(argc, argv));
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
