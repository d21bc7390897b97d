// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/rivals.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "bin_picking_perception/model/slight_turn.hpp"

namespace bin_picking
{
namespace
{
constexpr int MAX_SCENE_POINTS = 800;
constexpr std::size_t MAX_MODEL_POINTS = 400;
constexpr float OUTLIER = 9;          // squared: off by three halves of the tolerance is as wrong as anything
constexpr double OTHER_POSE = 0.1;    // of the diameter: nearer rivals are the same for a gripper
constexpr int FINE_STEPS = 4;         // to either side
constexpr double FINE_ANGLE = 0.044;  // rad: together half a step of the near symmetries

/// Measured points around a pose, in the part's frame.
struct Neighbourhood
{
  std::vector<Eigen::Vector3f> points;
  double area_per_point = 0;  ///< in squares of a leaf's edge
};

Neighbourhood measuredAround(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid)
{
  constexpr double REACH = 0.65;  // of the diameter, round the part's middle: rivals stick out a little
  const Eigen::Vector3d center = T_camera_object * model.center;
  if (center.z() <= 0)
    return {};  // behind the camera
  const Eigen::Vector2d middle = grid.camera.project(center);
  const double radius = REACH * model.diameter / grid.pitch(center.z());
  const int step =
      std::max(1, static_cast<int>(std::ceil(2 * radius / std::sqrt(static_cast<double>(MAX_SCENE_POINTS)))));
  const auto clampTo = [](double value, int count) { return static_cast<int>(std::clamp(value, 0.0, count - 1.0)); };
  const Eigen::Isometry3f T_object_camera = T_camera_object.inverse().cast<float>();
  Neighbourhood around;
  around.area_per_point = std::pow(step * grid.pitch(center.z()) / model.parameters.leaf, 2);
  for (int v = clampTo(middle.y() - radius, grid.height); v <= clampTo(middle.y() + radius, grid.height); v += step)
    for (int u = clampTo(middle.x() - radius, grid.width); u <= clampTo(middle.x() + radius, grid.width); u += step)
      if (grid.valid(grid.index(u, v)))
        around.points.push_back(T_object_camera * grid.point(grid.index(u, v)));
  return around;
}

/// Evenly chosen points of the surface; the same ones for all rivals, so that their sampling does not tell them apart.
struct SurfaceSamples
{
  explicit SurfaceSamples(const TrainedModel& model)
  {
    const std::size_t step = std::max<std::size_t>(1, model.surface.size() / MAX_MODEL_POINTS);
    for (std::size_t i = 0; i < model.surface.size(); i += step)
      indices.push_back(static_cast<int>(i));
    const double spacing = model.parameters.surface_spacing / model.parameters.leaf;
    area_per_point = spacing * spacing * static_cast<double>(step);
  }

  std::vector<int> indices;
  double area_per_point = 0;  ///< in squares of a leaf's edge
};

/// The sensor looked through the point: everything measured on its ray and beside it lies behind.
bool seenThrough(const DepthGrid& grid, const Eigen::Vector3f& p, float limit)
{
  constexpr int AROUND[5][2] = {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}};
  const PinholeCamera& camera = grid.camera;
  const float inverse_z = 1 / p.z();
  const float u = static_cast<float>(camera.fx) * p.x() * inverse_z + static_cast<float>(camera.cx) + 0.5f;
  const float v = static_cast<float>(camera.fy) * p.y() * inverse_z + static_cast<float>(camera.cy) + 0.5f;
  if (!(u >= 1 && v >= 1 && u < static_cast<float>(grid.width - 1) && v < static_cast<float>(grid.height - 1)))
    return false;
  const int middle = grid.index(static_cast<int>(u), static_cast<int>(v));
  return std::all_of(std::begin(AROUND), std::end(AROUND), [&](const int(&offset)[2]) {
    // false for NaN: nothing was measured
    return grid.z[static_cast<std::size_t>(middle + grid.index(offset[0], offset[1]))] >= p.z() + limit;
  });
}

/// What speaks against poses T_camera_object * turn: what was measured off the surface, and what of the surface the
/// sensor looked through. In squares of a leaf's edge, each at most OUTLIER / 2.
class Contradiction
{
public:
  Contradiction(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                const DepthGrid& surroundings, double tolerance)
      : model_(model),
        T_camera_object_(T_camera_object),
        surroundings_(surroundings),
        tolerance_(tolerance),
        around_(measuredAround(model, T_camera_object, grid)),
        samples_(model)
  {}

  /// Of every turn. From here on, of the measured points only those count that lie near the surface of one of these
  /// poses at least: they may belong to the part. What is more than MOST_MARGIN above the least is only known to be so.
  std::vector<double> ofAll(const std::vector<Pose>& turns)
  {
    std::vector<double> against = offSurfaceOfAll(turns);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < turns.size(); ++k)
    {
      against[k] += seenThroughShare(turns[k], least + MOST_MARGIN - against[k]);
      least = std::min(least, against[k]);
    }
    return against;
  }

  double operator()(const Pose& turn) const
  {
    double off = 0;
    const Eigen::Isometry3f T_turned_object = turn.inverse().cast<float>();
    for (const Eigen::Vector3f& p : around_.points)
      off += cost(model_.field.at(T_turned_object * p));
    return 0.5 * around_.area_per_point * off + seenThroughShare(turn, std::numeric_limits<double>::infinity());
  }

private:
  double cost(float distance) const
  {
    const float residual = distance * static_cast<float>(2 / tolerance_);
    return static_cast<double>(std::min(residual * residual, OUTLIER));
  }

  std::vector<double> offSurfaceOfAll(const std::vector<Pose>& turns)
  {
    std::vector<Eigen::Isometry3f> motions(turns.size());
    std::transform(turns.begin(), turns.end(), motions.begin(),
                   [](const Pose& turn) { return turn.inverse().cast<float>(); });
    const float near = 0.7f * model_.field.band();
    std::vector<double> sums(turns.size(), 0);
    std::vector<double> costs(turns.size());
    std::vector<Eigen::Vector3f> concerned;
    for (const Eigen::Vector3f& p : around_.points)
    {
      float nearest = near;
      for (std::size_t k = 0; k < motions.size(); ++k)
      {
        const float distance = model_.field.at(motions[k] * p);
        nearest = std::min(nearest, std::abs(distance));
        costs[k] = cost(distance);
      }
      if (nearest >= near)
        continue;
      concerned.push_back(p);
      for (std::size_t k = 0; k < sums.size(); ++k)
        sums[k] += costs[k];
    }
    around_.points = std::move(concerned);
    for (double& sum : sums)
      sum *= 0.5 * around_.area_per_point;
    return sums;
  }

  /// \param enough where the search may end
  double seenThroughShare(const Pose& turn, double enough) const
  {
    constexpr float MIN_COSINE = 0.35f;  // flatter, the ray passes the silhouette
    const Eigen::Isometry3f T = (T_camera_object_ * turn).cast<float>();
    const auto limit = static_cast<float>(0.5 * model_.parameters.leaf + tolerance_);
    const double each = 0.5 * samples_.area_per_point * static_cast<double>(OUTLIER);
    double sum = 0;
    for (auto k = samples_.indices.begin(); k != samples_.indices.end() && sum <= enough; ++k)
    {
      const auto i = static_cast<std::size_t>(*k);
      const Eigen::Vector3f p = T * model_.surface.points[i];
      const float towards = -(T.linear() * model_.surface.normals[i]).dot(p);
      if (p.z() > 0 && towards > 0 && towards * towards > MIN_COSINE * MIN_COSINE * p.squaredNorm() &&
          seenThrough(surroundings_, p, limit))
        sum += each;
    }
    return sum;
  }

  const TrainedModel& model_;
  Pose T_camera_object_;
  const DepthGrid& surroundings_;
  double tolerance_;
  Neighbourhood around_;
  SurfaceSamples samples_;
};

/// The best turn about the axis next to one of the steps. \param least contradiction of the step itself
Pose betweenSteps(const Pose& step, const Symmetry::Axis& axis, const Contradiction& contradiction, double least)
{
  Pose best = step;
  for (int k = -FINE_STEPS; k <= FINE_STEPS; ++k)
  {
    const Pose turn = step * rotationAbout(axis, k * FINE_ANGLE);
    const double against = contradiction(turn);
    if (against < least)
    {
      least = against;
      best = turn;
    }
  }
  return best;
}

/// Another pose than the chosen one.
struct Rival
{
  Pose turn;                             ///< from the chosen pose to it, part frame
  double margin = 0;                     ///< by which it is contradicted more
  const NearSymmetry* slight = nullptr;  ///< what that turn is, if it is slight
};

/// Turns about one axis that lead from the chosen pose to others, modulo the part's symmetry.
class TurnsAbout
{
public:
  TurnsAbout(const TrainedModel& model, const NearSymmetry& one)
      : model_(model), axis_(one.axis), any_(one.slight_all_around)
  {
    int largest = 0;
    axis_.direction.cwiseAbs().maxCoeff(&largest);
    if (axis_.direction[largest] < 0)
      axis_.direction = -axis_.direction;  // as a person would write it
  }

  bool leadTo(const Rival& rival) const
  {
    constexpr double SAME = 0.02;  // of the diameter
    if (rival.slight == nullptr)
      return false;
    const Pose& turn = rival.slight->T_object_object;
    return isSameLine(rival.slight->axis, axis_, SAME * model_.diameter) ||
           farthestMotion(model_, turn, rotationAbout(axis_, angleAbout(axis_, turn))) < SAME * model_.diameter;
  }

  /// What those of the rivals leave open that cannot be told from the chosen pose.
  UndeterminedTurn undetermined(const std::vector<Rival>& rivals, double min_margin) const
  {
    UndeterminedTurn open{axis_, {}, 0};
    for (const Rival& rival : rivals)
      if (rival.margin < min_margin && leadTo(rival))
      {
        open.deviation = std::max(open.deviation, rival.slight->deviation);
        if (!any_)
          open.angles.push_back(angleAbout(axis_, rival.slight->T_object_object));
      }
    std::sort(open.angles.begin(), open.angles.end());
    open.angles.erase(std::unique(open.angles.begin(), open.angles.end(),
                                  [](double a, double b) { return b - a < M_PI / NEAR_SYMMETRY_STEPS; }),
                      open.angles.end());
    return open;
  }

  /// Smallest margin of the rivals that the open turns do not lead to.
  double marginBeyond(const std::vector<Rival>& rivals, double min_margin) const
  {
    double margin = std::numeric_limits<double>::infinity();
    for (const Rival& rival : rivals)
      if (!leadTo(rival) || (!any_ && rival.margin >= min_margin))
        margin = std::min(margin, rival.margin);
    return margin;
  }

private:
  const TrainedModel& model_;
  Symmetry::Axis axis_;
  bool any_;
};

/// Where the slight rivals alone cannot be told apart, that is a turn left open.
void leaveTurnOpen(const TrainedModel& model, std::vector<Rival>& rivals, double min_margin, RivalChoice& choice)
{
  const Rival* nearest = nullptr;
  for (Rival& rival : rivals)
  {
    rival.slight = slightTurn(model, rival.turn);
    if (rival.slight != nullptr && rival.margin < min_margin && (nearest == nullptr || rival.margin < nearest->margin))
      nearest = &rival;
  }
  if (nearest == nullptr)
    return;
  const TurnsAbout turns(model, *nearest->slight);
  choice.undetermined_turn = turns.undetermined(rivals, min_margin);
  choice.margin_beyond_turn = turns.marginBeyond(rivals, min_margin);
}
}  // namespace

RivalChoice chooseAmongRivals(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid,
                              const DepthGrid& surroundings, double tolerance, double min_margin)
{
  RivalChoice choice;
  choice.T_camera_object = T_camera_object;
  if (model.near_symmetries.empty())
    return choice;
  std::vector<Pose> turns = {Pose::Identity()};
  for (const NearSymmetry& near : model.near_symmetries)
    turns.push_back(near.T_object_object);
  Contradiction contradiction(model, T_camera_object, grid, surroundings, tolerance);
  const std::vector<double> against = contradiction.ofAll(turns);
  const auto best = static_cast<std::size_t>(std::min_element(against.begin(), against.end()) - against.begin());
  if (best > 0)
  {
    choice.turned = true;
    choice.T_camera_object =
        T_camera_object * betweenSteps(turns[best], model.near_symmetries[best - 1].axis, contradiction, against[best]);
    choice.T_camera_object.linear() =
        Eigen::Quaterniond(choice.T_camera_object.linear()).normalized().toRotationMatrix();
  }
  // Steps against steps: a turn between them would seem surer than it is, for the others were not turned further.
  std::vector<Rival> rivals;
  for (std::size_t k = 0; k < turns.size(); ++k)
    if (k != best &&
        farthestMotion(model, T_camera_object * turns[k], choice.T_camera_object) > OTHER_POSE * model.diameter)
    {
      rivals.push_back({turns[best].inverse() * turns[k], against[k] - against[best]});
      choice.margin = std::min(choice.margin, rivals.back().margin);
    }
  choice.margin_beyond_turn = choice.margin;
  if (choice.margin < min_margin)
    leaveTurnOpen(model, rivals, min_margin, choice);
  return choice;
}

double surfaceShare(const TrainedModel& model, const Pose& T_camera_object, const DepthGrid& grid, double tolerance)
{
  constexpr float NEAR = 0.7f;  // of the band
  int near = 0;
  int on_surface = 0;
  for (const Eigen::Vector3f& p : measuredAround(model, T_camera_object, grid).points)
  {
    const float distance = std::abs(model.field.at(p));
    near += distance < NEAR * model.field.band();
    on_surface += distance < static_cast<float>(tolerance);
  }
  return near > 0 ? static_cast<double>(on_surface) / near : 0;
}
}  // namespace bin_picking
