// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// One part in an oriented point set: the six Stanford models moved at random under noise (as in the paper's Tables
// 1-4), and the UWA parasaurolophus in scene rs1. Usage: benchmark_point_sets DATA_DIR CONFIG_DIR [--trials N] [--set
// parameter=value ...] DATA_DIR holds stanford/*_100k.ply and uwa/; CONFIG_DIR holds the paper's constants
// (config/paper of this package).
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>

#include <yaml-cpp/yaml.h>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/detector.hpp"
#include "bin_picking_perception/evaluation/pose_error.hpp"

namespace fs = std::filesystem;
using namespace bin_picking;

namespace
{
/// Every model is scaled to this diagonal of its bounding box, so that the paper's millimetres mean something.
constexpr double MODEL_DIAGONAL = 0.25;

struct Options
{
  fs::path data;
  fs::path config;
  int trials = 3;
  std::vector<std::string> overrides;
  std::vector<std::string> training_overrides;
};

double uniform(std::mt19937& random) { return static_cast<double>(random()) / 4294967296.0; }

double gaussian(std::mt19937& random)
{
  const double u = 1 - uniform(random);
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * M_PI * uniform(random));
}

Pose randomMotion(std::mt19937& random)
{
  Eigen::Quaterniond q(gaussian(random), gaussian(random), gaussian(random), gaussian(random));
  Pose T = Pose::Identity();
  T.linear() = q.normalized().toRotationMatrix();
  for (int i = 0; i < 3; ++i)
    T.translation()[i] = 0.4 * uniform(random) - 0.2;
  return T;
}

/// Mean distance of a point to its nearest neighbour: the "mesh resolution".
double meshResolution(const std::vector<Eigen::Vector3f>& points)
{
  const KdTree tree(points);
  std::vector<int> neighbours;
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < points.size(); i += points.size() / 500)
  {
    float nearest = 1;
    tree.radiusSearch(points[i], 0.004f, neighbours);
    for (const int n : neighbours)
      if (static_cast<std::size_t>(n) != i)
        nearest = std::min(nearest, (points[static_cast<std::size_t>(n)] - points[i]).norm());
    sum += static_cast<double>(nearest);
    ++count;
  }
  return sum / count;
}

/// A copy of a point model at the wanted size, as a PLY file in metres.
fs::path scaledCopy(const fs::path& file, OrientedPoints& points)
{
  points = loadOrientedPoints(file.string(), LengthUnit::Metre);
  const auto scale = static_cast<float>(MODEL_DIAGONAL / boundingBoxDiagonal(points.points));
  for (auto& p : points.points)
    p *= scale;
  const fs::path copy = fs::temp_directory_path() / ("scaled_" + file.filename().string());
  std::ofstream out(copy);
  out << "ply\nformat ascii 1.0\nelement vertex " << points.size()
      << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float "
         "nz\nend_header\n";
  out.precision(9);
  for (std::size_t i = 0; i < points.size(); ++i)
    out << points.points[i].transpose() << " " << points.normals[i].transpose() << "\n";
  return copy;
}

void configure(const fs::path& file, const Options& options, TrainingParameters& training, DetectorParameters& detector)
{
  if (!file.empty())
  {
    const YAML::Node root = YAML::LoadFile(file.string());
    setParametersFromYaml(visitor(training), YAML::Dump(root["training"]), file.string());
    setParametersFromYaml(visitor(detector), YAML::Dump(root["detector"]), file.string());
  }
  for (const auto& assignment : options.training_overrides)
    setParameter(visitor(training), assignment);
  for (const auto& assignment : options.overrides)
    setParameter(visitor(detector), assignment);
}

struct Row
{
  double rate = 0;
  double worst_add = 0;  ///< of the diameter
  double milliseconds = 0;
  double votes = 0;
};

Row runModel(const fs::path& file, const fs::path& config, FeatureKind feature, const Options& options)
{
  TrainingParameters training;
  DetectorParameters parameters = DetectorParameters::preset("paper");
  configure(config, options, training, parameters);
  training.feature = feature;
  OrientedPoints surface;
  PartDefinition part;
  part.name = file.stem().string();
  part.mesh_file = scaledCopy(file, surface).string();
  const auto model = trainPart(part, training, Executor(0));
  fs::remove(part.mesh_file);
  const Detector detector({model}, parameters);
  const double sigma = 0.1 * meshResolution(surface.points);

  Row row;
  std::mt19937 random(1);
  for (int trial = 0; trial < options.trials; ++trial)
  {
    const Pose truth = randomMotion(random);
    OrientedPoints scene = transformed(surface, truth);
    for (auto& p : scene.points)
      for (int i = 0; i < 3; ++i)
        p[i] += static_cast<float>(sigma * gaussian(random));
    const DetectionResult result = detector.match(scene, true);
    if (result.detections.empty())
    {
      row.worst_add = 1;
      continue;
    }
    const Detection& best = result.detections.front();
    row.rate += best.matching_rate / options.trials;
    row.worst_add =
        std::max(row.worst_add, averageDistance(model->points.points, best.T_camera_object, truth) / model->diameter);
    row.milliseconds += 1e3 * result.total_seconds / options.trials;
    for (const auto& count : result.counts)
      if (count.stage == "votes")
        row.votes += count.count / options.trials;
  }
  return row;
}

void runStanford(const Options& options)
{
  const std::vector<std::pair<const char*, const char*>> models = {
      {"stanford_bunny_100k.ply", "bunny.yaml"}, {"dragon_100k.ply", "dragon.yaml"},
      {"lucy_100k.ply", "statuette.yaml"},       {"xyzrgb_dragon_100k.ply", "chinese_dragon.yaml"},
      {"armadillo_100k.ply", "armadillo.yaml"},  {"happy_100k.ply", "buddha.yaml"}};
  const std::vector<std::pair<const char*, FeatureKind>> features = {
      {"ppf", FeatureKind::Ppf},
      {"cur_ppf_unweighted", FeatureKind::CurPpfUnweighted},
      {"cur_ppf", FeatureKind::CurPpf}};
  for (const auto& [name, feature] : features)
  {
    double rate = 0;
    double worst = 0;
    for (const auto& [file, config] : models)
    {
      const Row row = runModel(options.data / "stanford" / file, options.config / config, feature, options);
      std::printf("%-20s %-26s matching rate %6.2f %%  worst ADD %.4f d  %7.1f ms  %.2e votes\n", name, file,
                  100 * row.rate, row.worst_add, row.milliseconds, row.votes);
      std::fflush(stdout);
      rate += row.rate / static_cast<double>(models.size());
      worst = std::max(worst, row.worst_add);
    }
    std::printf("%-20s average matching rate %.2f %%, worst ADD %.4f d\n", name, 100 * rate, worst);
  }
}

Pose readMatrix(const fs::path& file)
{
  std::ifstream in(file);
  Pose T = Pose::Identity();
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 4; ++c)
      in >> T.matrix()(r, c);
  T.translation() /= 1000;
  T.linear() = Eigen::Quaterniond(T.linear()).normalized().toRotationMatrix();
  return T;
}

void runUwa(const Options& options)
{
  TrainingParameters training;
  DetectorParameters parameters = DetectorParameters::preset("paper");
  parameters.voting.reference_share = 0.2;
  configure({}, options, training, parameters);
  PartDefinition part;
  part.name = "parasaurolophus";
  part.mesh_file = (options.data / "uwa" / "parasaurolophus_low_normals2.ply").string();
  part.mesh_unit = LengthUnit::Millimetre;
  const auto model = trainPart(part, training, Executor(0));
  const OrientedPoints scene =
      loadOrientedPoints((options.data / "uwa" / "rs1_normals.ply").string(), LengthUnit::Millimetre);
  const Pose truth = readMatrix(options.data / "uwa" / "pseudo_gt_parasaurolophus_rs1.xf");
  const DetectionResult result = Detector({model}, parameters).match(scene, false);
  std::printf("uwa rs1: leaf %.1f mm, %zu model points, %.0f ms\n", 1e3 * model->parameters.leaf, model->points.size(),
              1e3 * result.total_seconds);
  std::vector<Detection> poses = result.detections;
  poses.insert(poses.end(), result.rejected.begin(), result.rejected.end());
  for (std::size_t i = 0; i < std::min<std::size_t>(3, poses.size()); ++i)
  {
    const auto& d = poses[i];
    const auto error = poseError(d.T_camera_object, truth, {}, model->center);
    std::printf("  rank %zu: %.2f mm, %.2f deg of the given pose; matching rate %.3f, score %.3f %s\n", i,
                1e3 * error.translation, error.rotation * 180 / M_PI, d.matching_rate, d.score, d.rejection.c_str());
  }
}
}  // namespace

int main(int argc, char** argv)
{
  try
  {
    if (argc < 3)
      throw ParameterError(
          "usage: benchmark_point_sets DATA_DIR CONFIG_DIR [--trials N] [--train parameter=value] [--set "
          "parameter=value ...]");
    Options options;
    options.data = argv[1];
    options.config = argv[2];
    for (int i = 3; i + 1 < argc; i += 2)
    {
      const std::string name = argv[i];
      if (name == "--trials")
        options.trials = std::stoi(argv[i + 1]);
      else if (name == "--set")
        options.overrides.push_back(argv[i + 1]);
      else if (name == "--train")
        options.training_overrides.push_back(argv[i + 1]);
      else
        throw ParameterError("unknown option " + name);
    }
    runUwa(options);
    if (options.trials > 0)
      runStanford(options);
    return 0;
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
