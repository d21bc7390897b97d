// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/refinement/rivals.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
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

/// Keeps the points that lie near the surface of one of the poses at least: they may belong to the part.
void keepConcerned(Neighbourhood& around, const TrainedModel& model, const std::vector<Eigen::Isometry3f>& motions)
{
  const float near = 0.7f * model.field.band();
  const auto strange = [&](const Eigen::Vector3f& p) {
    return std::none_of(motions.begin(), motions.end(),
                        [&](const Eigen::Isometry3f& motion) { return std::abs(model.field.at(motion * p)) < near; });
  };
  around.points.erase(std::remove_if(around.points.begin(), around.points.end(), strange), around.points.end());
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
  const auto u = static_cast<int>(std::lround(camera.fx * static_cast<double>(p.x() / p.z()) + camera.cx));
  const auto v = static_cast<int>(std::lround(camera.fy * static_cast<double>(p.y() / p.z()) + camera.cy));
  for (const auto& offset : AROUND)
  {
    if (!grid.inside(u + offset[0], v + offset[1]))
      return false;
    const int i = grid.index(u + offset[0], v + offset[1]);
    if (!grid.valid(i) || grid.z[static_cast<std::size_t>(i)] < p.z() + limit)
      return false;
  }
  return true;
}

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

  void concern(const std::vector<Eigen::Isometry3f>& motions) { keepConcerned(around_, model_, motions); }

  /// Of the pose T_camera_object * turn: what was measured off its surface, and what of its surface the sensor looked
  /// through. In squares of a leaf's edge, each at most OUTLIER / 2.
  double operator()(const Pose& turn) const
  {
    return 0.5 * (around_.area_per_point * offSurface(turn) +
                  samples_.area_per_point * static_cast<double>(OUTLIER) * numSeenThrough(T_camera_object_ * turn));
  }

private:
  double offSurface(const Pose& turn) const
  {
    const Eigen::Isometry3f T_turned_object = turn.inverse().cast<float>();
    const auto scale = static_cast<float>(2 / tolerance_);
    double sum = 0;
    for (const Eigen::Vector3f& p : around_.points)
    {
      const float residual = model_.field.at(T_turned_object * p) * scale;
      sum += static_cast<double>(std::min(residual * residual, OUTLIER));
    }
    return sum;
  }

  int numSeenThrough(const Pose& T) const
  {
    constexpr float MIN_COSINE = 0.35f;  // flatter, the ray passes the silhouette
    const Eigen::Isometry3f T_camera_object = T.cast<float>();
    const auto limit = static_cast<float>(0.5 * model_.parameters.leaf + tolerance_);
    int count = 0;
    for (const int k : samples_.indices)
    {
      const auto i = static_cast<std::size_t>(k);
      const Eigen::Vector3f p = T_camera_object * model_.surface.points[i];
      const Eigen::Vector3f normal = T_camera_object.linear() * model_.surface.normals[i];
      count += p.z() > 0 && -normal.dot(p) > MIN_COSINE * p.norm() && seenThrough(surroundings_, p, limit);
    }
    return count;
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
  std::vector<Eigen::Isometry3f> motions = {Eigen::Isometry3f::Identity()};
  for (const NearSymmetry& near : model.near_symmetries)
  {
    turns.push_back(near.T_object_object);
    motions.push_back(near.T_object_object.inverse().cast<float>());
  }
  Contradiction contradiction(model, T_camera_object, grid, surroundings, tolerance);
  contradiction.concern(motions);
  std::vector<double> against(turns.size());
  std::transform(turns.begin(), turns.end(), against.begin(), std::cref(contradiction));
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
