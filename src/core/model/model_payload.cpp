// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "model_payload.hpp"

#include <algorithm>
#include <cmath>

#include "payload_shape.hpp"

namespace bin_picking
{
namespace
{
void write(BinaryWriter& out, const OrientedPoints& points)
{
  out.vectors(points.points);
  out.vectors(points.normals);
  out.array(points.curvature);
}

OrientedPoints readPoints(BinaryReader& in)
{
  OrientedPoints points;
  points.points = in.vectors();
  points.normals = in.vectors();
  points.curvature = in.array<float>();
  require(points.normals.size() == points.size(), "the numbers of points and normals differ");
  require(points.curvature.empty() || points.curvature.size() == points.size(),
          "the numbers of points and curvatures differ");
  return points;
}

void write(BinaryWriter& out, const std::vector<ViewTemplate>& views)
{
  out.value(static_cast<std::uint64_t>(views.size()));
  for (const ViewTemplate& view : views)
  {
    out.matrix(view.direction);
    out.value(view.area);
    out.value(view.contour);
    out.array(view.visible);
  }
}

std::vector<ViewTemplate> readViews(BinaryReader& in, std::size_t num_surface_points)
{
  // The smallest view: direction, area, contour and the size of an empty list.
  std::vector<ViewTemplate> views(in.count(5 * sizeof(float) + sizeof(std::uint64_t)));
  for (ViewTemplate& view : views)
  {
    view.direction = in.matrix<Eigen::Vector3f>();
    view.area = in.value<float>();
    view.contour = in.value<float>();
    view.visible = in.array<std::uint32_t>();
    for (const std::uint32_t index : view.visible)
      require(index < num_surface_points, "a view sees a surface point that does not exist");
  }
  return views;
}

void writeQuantizer(BinaryWriter& out, const FeatureQuantizer& q)
{
  for (const double step : {q.distance_step, q.angle_step, q.curvature_step, q.curvature_min})
    out.value(step);
  for (const int bins : {q.distance_bins, q.angle_bins, q.curvature_bins})
    out.value(static_cast<std::int32_t>(bins));
}

FeatureQuantizer readQuantizer(BinaryReader& in)
{
  FeatureQuantizer q;
  for (double* step : {&q.distance_step, &q.angle_step, &q.curvature_step, &q.curvature_min})
    *step = in.value<double>();
  for (int* bins : {&q.distance_bins, &q.angle_bins, &q.curvature_bins})
  {
    *bins = in.value<std::int32_t>();
    require(*bins > 0, "the feature table has a dimension without bins");
  }
  require(q.distance_step > 0 && q.angle_step > 0 && q.curvature_step > 0,
          "a step of the feature table is not positive");
  return q;
}

std::string parametersText(const TrainingParameters& parameters)
{
  TrainingParameters copy = parameters;
  return toYaml(visitor(copy));
}
}  // namespace

/// The parts of a feature table that nobody else needs to see.
struct ModelFileAccess
{
  static void write(BinaryWriter& out, const FeatureTable& table)
  {
    writeQuantizer(out, table.quantizer_);
    out.array(table.references_);
    out.array(table.cells_.words_);
    out.array(table.features_.words_);
    out.array(table.starts_);
    out.array(table.entries_);
  }

  static FeatureTable read(BinaryReader& in, std::size_t num_points)
  {
    FeatureTable table;
    table.quantizer_ = readQuantizer(in);
    table.references_ = in.array<std::uint32_t>();
    table.cells_.words_ = in.array<RankedBits::Word>();
    table.features_.words_ = in.array<RankedBits::Word>();
    table.starts_ = in.array<std::uint32_t>();
    table.entries_ = in.array<TableEntry>();
    check(table, num_points);
    return table;
  }

  static void write(BinaryWriter& out, const DistanceField& field)
  {
    out.value(field.band_);
    out.value(field.inverse_cell_);
    out.matrix(field.low_);
    out.value(static_cast<std::uint64_t>(field.columns_));
    out.value(static_cast<std::uint64_t>(field.rows_));
    out.array(field.values_);
  }

  static DistanceField readField(BinaryReader& in)
  {
    DistanceField field;
    field.band_ = in.value<float>();
    field.inverse_cell_ = in.value<float>();
    field.low_ = in.matrix<Eigen::Vector3f>();
    field.columns_ = static_cast<std::size_t>(in.value<std::uint64_t>());
    field.rows_ = static_cast<std::size_t>(in.value<std::uint64_t>());
    field.values_ = in.array<std::int16_t>();
    field.fillDerived();
    const std::size_t size = field.values_.size();
    require(size == 0 || (field.columns_ > 1 && field.columns_ <= size && field.rows_ > 1 &&
                          field.rows_ <= size / field.columns_ && size % (field.columns_ * field.rows_) == 0),
            "the distance field has another size than it claims");
    require(field.low_.allFinite() && field.band_ >= 0 && field.inverse_cell_ >= 0, "the distance field has no place");
    return field;
  }

private:
  /// \return the number of members
  static std::uint32_t checkRanks(const RankedBits& bits, double size)
  {
    require(bits.words_.size() == static_cast<std::size_t>(size) / RankedBits::BITS + 1,
            "a bit map of the feature table is not as large as its steps ask for");
    RankedBits counted = bits;
    const std::uint32_t count = counted.rankMembers();
    for (std::size_t k = 0; k < bits.words_.size(); ++k)
      require(bits.words_[k].rank == counted.words_[k].rank, "the features of the table are counted wrongly");
    return count;
  }

  /// A search in the table must stay within its arrays.
  static void check(const FeatureTable& table, std::size_t num_points)
  {
    const FeatureQuantizer& q = table.quantizer_;
    const double geometric_keys = std::pow(q.angle_bins, 3) * q.distance_bins;
    const double curvatures = std::pow(q.curvature_bins, 2);
    require(geometric_keys * curvatures < 4294967295.0, "the feature table has more features than can be told apart");
    const std::uint32_t num_cells = checkRanks(table.cells_, geometric_keys);
    const std::uint32_t num_features = checkRanks(table.features_, num_cells * curvatures);
    require(table.starts_.size() == num_features + std::size_t{1} && table.starts_.front() == 0 &&
                table.starts_.back() == table.entries_.size() &&
                std::is_sorted(table.starts_.begin(), table.starts_.end()),
            "a feature of the table points behind its entries");
    for (const std::uint32_t reference : table.references_)
      require(reference < num_points, "the feature table names a point that does not exist");
    for (const TableEntry& entry : table.entries_)
      require(entry.reference() < table.references_.size(),
              "an entry of the feature table names a reference that does not exist");
  }
};

std::vector<char> writePayload(const TrainedModel& model)
{
  BinaryWriter out;
  out.text(model.name);
  out.value(model.mesh_hash);
  out.value(model.parameter_hash);
  out.text(parametersText(model.parameters));
  write(out, model.symmetry);
  write(out, model.mesh);
  out.matrix(model.size);
  out.matrix(model.center);
  out.value(model.diameter);
  write(out, model.points);
  write(out, model.surface);
  write(out, model.views);
  out.value(model.classes.low_max);
  out.value(model.classes.high_min);
  ModelFileAccess::write(out, model.table);
  write(out, model.edges);
  ModelFileAccess::write(out, model.edge_table);
  write(out, model.remarks);
  ModelFileAccess::write(out, model.field);
  write(out, model.near_symmetries);
  out.array(model.near_crease);
  return out.take();
}

namespace
{
/// Lengths with which the online phase can work.
bool isPlausible(const TrainedModel& model)
{
  constexpr float MAX_COORDINATE = 10;  // metres
  const auto is_sane = [](const Eigen::Vector3f& p) {
    return p.allFinite() && p.cwiseAbs().maxCoeff() < MAX_COORDINATE;
  };
  const double leaf = model.parameters.leaf;
  return (model.surface.empty() || (leaf > 0 && leaf < static_cast<double>(MAX_COORDINATE))) &&
         std::all_of(model.surface.points.begin(), model.surface.points.end(), is_sane) &&
         std::all_of(model.mesh.vertices.begin(), model.mesh.vertices.end(), is_sane);
}
}  // namespace

std::shared_ptr<const TrainedModel> readPayload(const char* begin, std::size_t size)
{
  BinaryReader in(begin, size);
  auto model = std::make_shared<TrainedModel>();
  model->name = in.text();
  model->mesh_hash = in.value<std::uint64_t>();
  model->parameter_hash = in.value<std::uint64_t>();
  setParametersFromYaml(visitor(model->parameters), in.text(), "parameters in the model");
  model->symmetry = readSymmetry(in);
  model->mesh = readMesh(in);
  model->size = in.matrix<Eigen::Vector3d>();
  model->center = in.matrix<Eigen::Vector3d>();
  model->diameter = in.value<double>();
  model->points = readPoints(in);
  model->surface = readPoints(in);
  model->views = readViews(in, model->surface.size());
  model->classes.low_max = in.value<double>();
  model->classes.high_min = in.value<double>();
  model->table = ModelFileAccess::read(in, model->points.size());
  model->edges = readPoints(in);
  model->edge_table = ModelFileAccess::read(in, model->points.size());
  require(model->edge_table.references() == model->table.references() || model->edges.empty(),
          "surface and edges have different references");
  model->remarks = readTexts(in);
  model->field = ModelFileAccess::readField(in);
  model->near_symmetries = readNearSymmetries(in);
  model->near_crease = in.array<std::uint8_t>();
  require(model->near_crease.size() == model->surface.size(), "surface and creases differ in size");
  require(in.left() == 0, "there are more data than a model has");
  require(isPlausible(*model), "lengths are absurd");
  return model;
}
}  // namespace bin_picking
