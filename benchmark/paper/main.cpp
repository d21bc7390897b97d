// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
//
// One experiment of benchmark/paper.sh, which writes the specification and reads the result.
// Usage: benchmark_paper SPECIFICATION.json RESULT.json
// The result is written when the experiment is complete, so that one that is there need not run again. Scratch files go
// into the result's folder.
#include <filesystem>
#include <fstream>
#include <iostream>

#include "bin_picking_perception/common/error.hpp"
#include "experiments.hpp"

namespace
{
using namespace bin_picking;
using paper::Json;

Json load(const std::string& file)
{
  std::ifstream in(file);
  if (!in)
    throw FileError("The specification " + file + " cannot be read; check its name.");
  return Json::parse(in);
}

Json run(const Json& specification, const std::string& folder)
{
  const auto kind = specification.at("kind").get<std::string>();
  if (kind == "points")
    return paper::runPoints(specification, folder);
  if (kind == "bins")
    return paper::runBins(specification, folder);
  if (kind == "curvature")
    return paper::runCurvature(specification, folder);
  if (kind == "segmentation")
    return paper::runSegmentation(specification, folder);
  throw ParameterError("the kind of experiment is '" + kind +
                       "', but it must be points, bins, curvature or segmentation");
}

void save(const Json& result, const std::string& file)
{
  const std::string unfinished = file + ".part";
  std::ofstream out(unfinished);
  out << result.dump(1) << "\n";
  out.close();
  if (!out)
    throw FileError("The result " + unfinished + " cannot be written; check that its folder exists.");
  std::filesystem::rename(unfinished, file);
}
}  // namespace

int main(int argc, char** argv)
{
  try
  {
    if (argc != 3)
      throw ParameterError("usage: benchmark_paper SPECIFICATION.json RESULT.json");
    const std::filesystem::path folder = std::filesystem::absolute(argv[2]).parent_path();
    const Json specification = load(argv[1]);
    Json result = run(specification, folder.string());
    result["specification"] = specification;
    save(result, argv[2]);
    return 0;
  }
  catch (const std::exception& error)
  {
    std::cerr << "benchmark_paper: " << error.what() << "\n";
    return 1;
  }
}
