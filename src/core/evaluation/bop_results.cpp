// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/evaluation/bop_results.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

#include "bin_picking_perception/common/error.hpp"
#include "rigid_pose.hpp"

namespace bin_picking
{
namespace
{
constexpr const char* HEADER = "scene_id,im_id,obj_id,score,R,t,time";
constexpr double MILLIMETRES_PER_METRE = 1000;

std::string trimmed(const std::string& text)
{
  const char* blank = " \t\r\"";
  const auto first = text.find_first_not_of(blank);
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::vector<std::string> splitLine(const std::string& line)
{
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');)
    cells.push_back(trimmed(cell));
  return cells;
}

/// One line of the file, and how to complain about it.
class Line
{
public:
  Line(std::vector<std::string> cells, std::string origin) : cells_(std::move(cells)), origin_(std::move(origin))
  {
    if (cells_.size() != 7)
      fail("has " + std::to_string(cells_.size()) + " cells, but 7 are needed: " + HEADER);
  }

  BopResult read() const
  {
    BopResult result;
    result.scene_id = integer(0);
    result.image_id = integer(1);
    result.object_id = integer(2);
    result.score = numbers(3, 1)[0];
    const std::vector<double> R = numbers(4, 9);
    const std::vector<double> t = numbers(5, 3);
    result.T_camera_object =
        rigidPose(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R.data()),
                  Eigen::Vector3d(t[0], t[1], t[2]) / MILLIMETRES_PER_METRE, "The pose in " + origin_);
    result.seconds = numbers(6, 1)[0];
    return result;
  }

private:
  [[noreturn]] void fail(const std::string& what) const
  {
    throw FileError("A result in " + origin_ + " " + what + ".");
  }

  std::vector<double> numbers(std::size_t cell, std::size_t count) const
  {
    std::istringstream in(cells_[cell]);
    in.imbue(std::locale::classic());
    std::vector<double> values;
    for (double value = 0; in >> value;)
      values.push_back(value);
    if (!in.eof() || values.size() != count)
      fail("has '" + cells_[cell] + "' where " + std::to_string(count) +
           (count == 1 ? " number is" : " numbers with spaces between them are") + " needed");
    return values;
  }

  int integer(std::size_t cell) const
  {
    const double value = numbers(cell, 1)[0];
    if (!(value >= 0 && value <= std::numeric_limits<int>::max()) || value != std::floor(value))
      fail("has '" + cells_[cell] + "' where a whole number that is not negative is needed");
    return static_cast<int>(value);
  }

  std::vector<std::string> cells_;
  std::string origin_;
};

std::string idText(int scene, int image, int object)
{
  return std::to_string(scene) + "/" + std::to_string(image) + "/" + std::to_string(object);
}
}  // namespace

std::vector<BopResult> loadBopResults(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  std::string line;
  if (!file || !std::getline(file, line))
    throw FileError("The results file " + path + " is missing, empty or cannot be read; check the path.");
  if (trimmed(line) != HEADER)
    throw FileError("The results file " + path + " begins with '" + trimmed(line).substr(0, 80) +
                    "', but its first line must be: " + HEADER + ".");
  std::vector<BopResult> results;
  for (int number = 2; std::getline(file, line); ++number)
    if (!trimmed(line).empty())
      results.push_back(Line(splitLine(line), "line " + std::to_string(number) + " of " + path).read());
  return results;
}

std::string bopResultsCsv(const std::vector<BopResult>& results)
{
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(std::numeric_limits<double>::max_digits10);
  out << HEADER << "\n";
  for (const BopResult& result : results)
  {
    out << result.scene_id << "," << result.image_id << "," << result.object_id << "," << result.score << ",";
    for (int k = 0; k < 9; ++k)
      out << (k > 0 ? " " : "") << result.T_camera_object.linear()(k / 3, k % 3);
    out << ",";
    for (int k = 0; k < 3; ++k)
      out << (k > 0 ? " " : "") << result.T_camera_object.translation()[k] * MILLIMETRES_PER_METRE;
    out << "," << result.seconds << "\n";
  }
  return out.str();
}

ResultsOfScenes assignToScenes(const std::vector<BopResult>& results, const EvaluationDataset& dataset,
                               const std::string& origin)
{
  std::map<std::pair<int, int>, std::size_t> scenes;
  for (std::size_t k = 0; k < dataset.scenes.size(); ++k)
    scenes[{dataset.scenes[k].scene_id, dataset.scenes[k].image_id}] = k;
  std::map<int, std::string> names;
  for (const EvaluationPart& part : dataset.parts)
    names[part.object_id] = part.definition.name;
  ResultsOfScenes assigned;
  assigned.estimates.resize(dataset.scenes.size());
  assigned.seconds.assign(dataset.scenes.size(), -1);
  for (const BopResult& result : results)
  {
    const auto scene = scenes.find({result.scene_id, result.image_id});
    const auto name = names.find(result.object_id);
    const auto* parts = scene == scenes.end() ? nullptr : &dataset.scenes[scene->second].parts;
    if (!parts || name == names.end() || std::find(parts->begin(), parts->end(), name->second) == parts->end())
    {
      ++assigned.left_out;
      continue;
    }
    assigned.estimates[scene->second].push_back({name->second, result.T_camera_object, result.score});
    assigned.seconds[scene->second] = std::max(assigned.seconds[scene->second], result.seconds);
  }
  if (!results.empty() && assigned.left_out == results.size())
    throw FileError("None of the " + std::to_string(results.size()) + " results of " + origin +
                    " belongs to the data set: the first is of scene/image/object " +
                    idText(results[0].scene_id, results[0].image_id, results[0].object_id) +
                    ", the first of the data set is " +
                    idText(dataset.scenes[0].scene_id, dataset.scenes[0].image_id, dataset.parts[0].object_id) +
                    "; give the results of this data set and split.");
  return assigned;
}
}  // namespace bin_picking
