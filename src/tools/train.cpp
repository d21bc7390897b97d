// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <filesystem>
#include <iomanip>
#include <iostream>

#include "bin_picking_perception/common/figures.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "bin_picking_perception/model/trained_model.hpp"
#include "commands.hpp"
#include "detector_options.hpp"
#include "terminal.hpp"

namespace bin_picking::tools
{
namespace
{
namespace fs = std::filesystem;

bool isPartDescription(const std::string& path)
{
  return fs::is_directory(path) || fs::path(path).extension() == ".yaml";
}

/// The part that a folder describes, or a bare mesh of the unit that was given.
PartDefinition partFrom(const Arguments& arguments)
{
  const std::string& path = arguments.positional(0);
  if (isPartDescription(path))
  {
    PartDefinition part = loadPart(path);
    if (arguments.has("--unit") && parseLengthUnit(arguments.value("--unit")) != part.mesh_unit)
      throw UsageError("--unit is " + arguments.value("--unit") + ", but the part.yaml of '" + path + "' says " +
                       toString(part.mesh_unit) + "; leave --unit away or correct the file");
    return part;
  }
  if (!arguments.has("--unit"))
    throw UsageError("a mesh file does not say its unit of length; add --unit mm (or m, cm, inch) for '" + path + "'");
  PartDefinition part;
  part.name = fs::path(path).stem().string();
  part.mesh_file = path;
  part.mesh_unit = parseLengthUnit(arguments.value("--unit"));
  return part;
}

/// Defaults, then the part's own choices, then those of the command line.
TrainingParameters trainingParameters(const Arguments& arguments, const PartDefinition& part)
{
  Configuration configuration;
  TrainingParameters& parameters = configuration.training;
  if (!part.training_yaml.empty())
    setParametersFromYaml(visitor(parameters), part.training_yaml, "the part.yaml of " + part.name);
  applyConfigFile(arguments, configuration);
  if (arguments.has("--leaf"))
    setParameter(visitor(parameters), "leaf", arguments.value("--leaf"));
  applyAssignments(arguments, visitor(parameters));
  return parameters;
}

void printLine(const std::string& title, const std::string& text)
{
  std::cout << "  " << std::left << std::setw(21) << title << text << "\n";
}

std::string millimetres(const Eigen::Vector3d& size)
{
  return roundedText(size.x() * 1000, 1) + " x " + roundedText(size.y() * 1000, 1) + " x " +
         roundedText(size.z() * 1000, 1) + " mm";
}

std::string symmetryText(const Symmetry& symmetry)
{
  if (symmetry.trivial())
    return "none";
  std::string text = symmetry.continuous ? "axis of revolution" : "";
  if (symmetry.discrete.size() > 1)
    text += std::string(text.empty() ? "" : ", ") + std::to_string(symmetry.discrete.size()) + " equal attitudes";
  return text;
}

void printMesh(const TrainedModel& model)
{
  printLine("size", millimetres(model.size) + ", diameter " + roundedText(model.diameter * 1000, 1) + " mm");
  if (model.mesh.empty())
    return;
  const MeshReport report = inspectMesh(model.mesh);
  printLine("mesh", std::to_string(model.mesh.triangles.size()) + " triangles, " + std::to_string(report.open_edges) +
                        " open edges, volume " + roundedText(report.volume * 1e6, 2) + " cm^3");
  for (const std::string& warning : report.warnings)
    std::cerr << "warning: " << warning << "\n";
}

std::string parameterText(const ParameterEntry& entry)
{
  if (entry.unit == "m")
    return roundedText(1000 * parseQuantity(entry.value, "m"), 3) + " mm";
  return entry.value + (entry.unit.empty() ? "" : " " + entry.unit);
}

void printSummary(TrainedModel model, double seconds, const std::string& path)
{
  std::cout << model.name << "\n";
  printMesh(model);
  printLine("symmetry", symmetryText(model.symmetry));
  for (const std::string& remark : model.remarks)
    printLine("found", remark);
  printLine("points", std::to_string(model.points.size()) + " at the leaf, " + std::to_string(model.surface.size()) +
                          " on the surface, " + std::to_string(model.views.size()) + " views");
  printLine("pairs", std::to_string(model.table.numEntries()) + " under " + std::to_string(model.table.numKeys()) +
                         " features, " + roundedText(static_cast<double>(model.table.bytes()) / 1048576, 1) + " MiB");
  printLine("edges", std::to_string(model.edges.size()) + " points where faces end, in " +
                         std::to_string(model.edge_table.numEntries()) + " pairs, " +
                         roundedText(static_cast<double>(model.edge_table.bytes()) / 1048576, 1) + " MiB");
  printLine("low curvature", "up to " + roundedText(model.classes.low_max, 1));
  printLine("high curvature", "above " + roundedText(model.classes.high_min, 1));
  for (const ParameterEntry& entry : listParameters(visitor(model.parameters)))
    printLine(entry.path, parameterText(entry));
  printLine("time", roundedText(seconds, 1) + " s");
  printLine("written to", path);
}

void train(const Arguments& arguments)
{
  const PartDefinition declared = partFrom(arguments);
  const TrainingParameters parameters = trainingParameters(arguments, declared);
  PartDefinition part = declared;
  part.training_yaml.clear();  // already in the parameters, below the command line
  const Executor executor(parseInteger(arguments.value("--threads", "0"), "--threads", 0, 1024));
  const std::string path = arguments.value("-o", part.name + ".model");
  const Stopwatch watch;
  Progress progress;
  const auto model = trainPart(part, parameters, executor, [&](const std::string& stage) { progress.show(stage); });
  saveModel(*model, path);
  progress.finish();
  printSummary(*model, watch.seconds(), path);
}
}  // namespace

Command trainCommand()
{
  return {{"train",
           "Learns a part from its CAD mesh and writes the model that detect and match read.",
           {"PART_DIR|MESH"},
           {{"--unit", "UNIT", Values::One, "unit of a bare mesh: m, cm, mm or inch (part.yaml states its own)"},
            {"--leaf", "LENGTH", Values::One, "distance of the model's points, e.g. 3mm (default: from the size)"},
            {"--config", "FILE.yaml", Values::One, "training parameters that differ from the default, under training:"},
            {"--set", "KEY=VALUE", Values::Assignments, "single training parameters, last word"},
            {"--threads", "N", Values::One, "threads to use; 0: all processors (default)"},
            {"-o", "MODEL", Values::One, "file to write (default: NAME.model in the working folder)"}},
           "train config/parts/three_way_tube --leaf 3mm -o tube.model"},
          train};
}
}  // namespace bin_picking::tools
