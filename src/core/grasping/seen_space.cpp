// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "seen_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

namespace bin_picking
{
namespace
{
constexpr float FAR_AWAY = 1e4f;     // metres: free all along the ray; finite, so that products stay numbers
constexpr float MIN_DEPTH = 0.05f;   // metres: what is nearer to the camera has no place in the picture
constexpr double MAX_EXTENSION = 2;  // of the picture's size, to either side

int wholeBlocks(int pixels) { return (pixels + BLOCK - 1) / BLOCK * BLOCK; }

/// Where the ray enters the inside of the bin, through its rim or behind a wall that hides it; 0 if the camera is in
/// there, FAR_AWAY if the ray passes by.
float depthAtRim(const Bin& bin, const Pose& T_bin_camera, const Eigen::Vector3d& ray)
{
  const Eigen::Array3d direction = T_bin_camera.linear() * ray;
  const Eigen::Array3d camera = T_bin_camera.translation();
  const Eigen::Array3d half = bin.inner_size.array() * Eigen::Array3d(0.5, 0.5, 1);
  const Eigen::Array3d low = half * Eigen::Array3d(-1, -1, 0);
  double enters = 0;
  double leaves = static_cast<double>(FAR_AWAY);
  for (int axis = 0; axis < 3; ++axis)
  {
    // A ray along the faces is between them all the time or never: the infinite quotients say so.
    const double a = (low[axis] - camera[axis]) / direction[axis];
    const double b = (half[axis] - camera[axis]) / direction[axis];
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  }
  return enters <= leaves ? static_cast<float>(enters) : FAR_AWAY;
}

/// Lines are worked on in bundles, each by one thread: task(first, end).
template <typename Task>
void forEachBundle(std::size_t count, const Executor& executor, const Task& task)
{
  constexpr std::size_t BUNDLE = 64;
  executor.forEach((count + BUNDLE - 1) / BUNDLE,
                   [&](std::size_t b) { task(b * BUNDLE, std::min(count, (b + 1) * BUNDLE)); });
}
template <typename Task>
void forEachLine(std::size_t count, const Executor& executor, const Task& task)
{
  forEachBundle(count, executor, [&](std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i)
      task(i);
  });
}

/// Calls visit(k) for each k < count with a[k] != b[k]; there are few.
template <typename Visit>
void forEachDifference(const std::uint8_t* a, const std::uint8_t* b, std::size_t count, const Visit& visit)
{
  constexpr std::size_t AT_ONCE = 8;
  for (std::size_t k = 0; k < count; k += AT_ONCE)
  {
    const std::size_t end = std::min(k + AT_ONCE, count);
    if (std::memcmp(a + k, b + k, end - k) == 0)
      continue;
    for (std::size_t i = k; i < end; ++i)
      if (a[i] != b[i])
        visit(i);
  }
}

std::vector<Eigen::Vector3d> cornersOf(const Bin& bin)
{
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5})
      for (const double z : {0.0, 1.0})
        corners.push_back(bin.T_camera_bin * bin.inner_size.cwiseProduct(Eigen::Vector3d(x, y, z)));
  return corners;
}
}  // namespace

SeenSpace::SeenSpace(const DepthGrid& measured, const Bin* bin, const ObstacleParameters& parameters,
                     const Executor& executor)
    : surface_clearance_(static_cast<float>(parameters.surface_clearance)),
      unseen_entry_(static_cast<float>(parameters.unseen_entry)),
      shadow_entry_(static_cast<float>(parameters.shadow_entry))
{
  layOut(measured, bin);
  bridgeGaps(measured, executor);
  if (bin)
    forEachLine(static_cast<std::size_t>(height_), executor,
                [&](std::size_t v) { hideBin(*bin, static_cast<int>(v)); });
  constexpr std::size_t STEPS = 3;
  executor.forEach(STEPS, [&](std::size_t step) {
    if (step == 0)
      allowed_ = allowedDepth(unseen_entry_);
    else if (step == 1)
      allowed_own_ = allowedDepth(shadow_entry_);
    else
      boundBlocks();
  });
}

void SeenSpace::layOut(const DepthGrid& measured, const Bin* bin)
{
  const PinholeCamera& camera = measured.camera;
  Eigen::AlignedBox2d picture(Eigen::Vector2d::Zero(), Eigen::Vector2d(measured.width, measured.height));
  const Eigen::Vector2d most = MAX_EXTENSION * picture.sizes();
  const Eigen::AlignedBox2d largest(-most, picture.max() + most);
  if (bin)
    for (const Eigen::Vector3d& corner : cornersOf(*bin))  // beside the camera or behind it: the bin may be on any ray
      picture.extend(corner.z() > static_cast<double>(MIN_DEPTH) ? Eigen::AlignedBox2d(camera.project(corner))
                                                                 : largest);
  picture = picture.intersection(largest);
  left_ = static_cast<int>(std::ceil(-picture.min().x()));
  top_ = static_cast<int>(std::ceil(-picture.min().y()));
  width_ = left_ + static_cast<int>(std::ceil(picture.max().x()));
  height_ = top_ + static_cast<int>(std::ceil(picture.max().y()));
  stride_ = wholeBlocks(width_);
  fx_ = static_cast<float>(camera.fx);
  fy_ = static_cast<float>(camera.fy);
  step_ = {1 / fx_, 1 / fy_};
  cx_ = static_cast<float>(camera.cx + left_);
  cy_ = static_cast<float>(camera.cy + top_);
  const auto pixels = static_cast<std::size_t>(stride_ * wholeBlocks(height_));
  depth_.assign(pixels, FAR_AWAY);
  measured_.assign(pixels, 0);
  hidden_by_.assign(pixels, -1);
}

void SeenSpace::copyRow(const DepthGrid& measured, int v)
{
  const float* z = &measured.z[static_cast<std::size_t>(measured.index(0, v))];
  float* depth = &depth_[index(left_, top_ + v)];
  std::uint8_t* known = &measured_[index(left_, top_ + v)];
  for (int u = 0; u < measured.width; ++u)
  {
    known[u] = std::isnan(z[u]) ? std::uint8_t{0} : std::uint8_t{1};
    depth[u] = std::isnan(z[u]) ? FAR_AWAY : z[u];
  }
}

/// Along rows and columns; where both bridge, the nearer counts.
void SeenSpace::bridgeGaps(const DepthGrid& measured, const Executor& executor)
{
  const auto width = static_cast<std::size_t>(measured.width);
  const auto height = static_cast<std::size_t>(measured.height);
  const auto stride = static_cast<std::size_t>(stride_);
  if (width == 0 || height == 0)
    return;
  const auto row = [&](std::size_t v) { return Line{index(left_, top_ + static_cast<int>(v)), 1, width}; };
  const auto column = [&](std::size_t u) { return Line{index(left_ + static_cast<int>(u), top_), stride, height}; };
  std::vector<Ends> rows(height);
  std::vector<Ends> columns(width);
  forEachLine(height, executor, [&](std::size_t v) {
    copyRow(measured, static_cast<int>(v));
    const std::size_t begin = row(v).begin;
    if (measured_[begin] != 0)
      change(rows[v], begin, 1);
    forEachDifference(&measured_[begin + 1], &measured_[begin], width - 1,
                      [&](std::size_t k) { change(rows[v], begin + 1 + k, 1); });
    if (measured_[begin + width - 1] != 0)
      rows[v].last = begin + width - 1;
  });
  forEachBundle(width, executor, [&](std::size_t first, std::size_t end) {
    for (std::size_t u = first; u < end; ++u)
      if (measured_[row(0).begin + u] != 0)
        change(columns[u], row(0).begin + u, stride);
    for (std::size_t v = 1; v < height; ++v)
      forEachDifference(&measured_[row(v).begin + first], &measured_[row(v - 1).begin + first], end - first,
                        [&](std::size_t k) { change(columns[first + k], row(v).begin + first + k, stride); });
    for (std::size_t u = first; u < end; ++u)
      if (measured_[row(height - 1).begin + u] != 0)
        columns[u].last = row(height - 1).begin + u;
  });
  forEachLine(height, executor, [&](std::size_t v) { goOnBeyond(rows[v], row(v), columns); });
  forEachLine(width, executor, [&](std::size_t u) { goOnBeyond(columns[u], column(u), rows); });
}

/// At the first pixel of a line, or where it changes between measured and not.
void SeenSpace::change(Ends& ends, std::size_t pixel, std::size_t step)
{
  if (measured_[pixel] == 0)
    ends.last = pixel - step;
  else if (ends.any)
    bridge(ends.last, pixel, step);
  else
    ends = {true, pixel, pixel};
}

/// A straight line between two measured pixels.
void SeenSpace::bridge(std::size_t begin, std::size_t end, std::size_t step)
{
  const std::size_t count = (end - begin) / step;
  const float a = depth_[begin];
  const float b = depth_[end];
  for (std::size_t k = 1; k < count; ++k)
  {
    // Along a straight line in space the inverse of the depth is linear in the picture.
    const float share = static_cast<float>(k) / static_cast<float>(count);
    offer(begin + k * step, a * b / (b + share * (a - b)), a < b ? begin : end);
  }
}

/// Before the first measured pixel of a row or column, and after the last, its depth goes on where nothing bridges.
/// \param crossing what crosses the line, pixel by pixel
void SeenSpace::goOnBeyond(const Ends& ends, const Line& line, const std::vector<Ends>& crossing)
{
  if (!ends.any)
    return;
  const auto goOn = [&](std::size_t k, std::size_t from) {
    const std::size_t i = line.begin + k * line.step;
    if (!crossing[k].any || i < crossing[k].first || i > crossing[k].last)
      offer(i, depth_[from], from);
  };
  for (std::size_t k = 0; k < (ends.first - line.begin) / line.step; ++k)
    goOn(k, ends.first);
  for (std::size_t k = (ends.last - line.begin) / line.step + 1; k < line.count; ++k)
    goOn(k, ends.last);
}

/// Of a row: the inside of the bin is unknown where the picture does not show it.
void SeenSpace::hideBin(const Bin& bin, int v)
{
  const Pose T_bin_camera = bin.T_camera_bin.inverse();
  for (int u = 0; u < width_; ++u)
    if (depth_[index(u, v)] == FAR_AWAY)
      depth_[index(u, v)] = depthAtRim(bin, T_bin_camera, ray(u, v).cast<double>());
}

/// The nearer of what is said of a pixel remains.
void SeenSpace::offer(std::size_t pixel, float depth, std::size_t hidden_by)
{
  if (depth >= depth_[pixel])
    return;
  depth_[pixel] = depth;
  hidden_by_[pixel] = static_cast<std::int32_t>(hidden_by);
}

/// The largest depth within `entry` along rows and columns, and `entry` more: how far a body may go that may be off the
/// free rays by that.
std::vector<float> SeenSpace::allowedDepth(float entry) const
{
  float farthest = 0;
  for (std::size_t i = 0; i < depth_.size(); ++i)
    if (measured_[i] != 0)
      farthest = std::max(farthest, depth_[i]);
  const int reach = farthest > 0 ? static_cast<int>(entry * std::sqrt(fx_ * fy_) / farthest) : 0;
  const auto stride = static_cast<std::size_t>(stride_);
  const auto width = static_cast<std::size_t>(width_);
  const auto margin = static_cast<std::size_t>(reach);
  const std::size_t window = 2 * margin + 1;
  std::vector<float> allowed(depth_.size() + 2 * margin * stride, 0.0f);
  std::vector<float> row(width + 2 * margin);
  for (std::size_t v = 0; v < static_cast<std::size_t>(height_); ++v)
  {
    std::fill(row.begin(), row.end(), 0.0f);
    std::copy_n(&depth_[v * stride], width, row.begin() + reach);
    raiseToWindow(row.data(), row.size(), 1, window);
    std::copy_n(row.begin(), width, &allowed[(v + margin) * stride]);
  }
  raiseToWindow(allowed.data(), allowed.size(), stride, window);
  allowed.resize(depth_.size());
  for (float& depth : allowed)
    depth += entry;
  // What fills up the last blocks is no part of the picture.
  const auto rows = static_cast<std::size_t>(height_);
  std::fill(allowed.begin() + static_cast<std::ptrdiff_t>(rows * stride), allowed.end(), FAR_AWAY + entry);
  for (std::size_t v = 0; v < rows; ++v)
    std::fill_n(&allowed[v * stride + width], stride - width, FAR_AWAY + entry);
  return allowed;
}

void SeenSpace::boundBlocks()
{
  const std::size_t blocks = depth_.size() / (BLOCK * BLOCK);
  block_nearest_.assign(blocks + BLOCK, FAR_AWAY);  // BLOCK of them are read at once
  block_points_.assign(blocks, Sphere{});
  for (int v = 0; v < static_cast<int>(depth_.size()) / stride_; v += BLOCK)
    for (int u = 0; u < stride_; u += BLOCK)
    {
      float nearest = FAR_AWAY;
      float nearest_point = FAR_AWAY;
      float farthest_point = 0;
      for (int row = 0; row < BLOCK; ++row)
        for (std::size_t i = index(u, v + row); i < index(u + BLOCK, v + row); ++i)
        {
          nearest = std::min(nearest, depth_[i]);
          nearest_point = std::min(nearest_point, measured_[i] != 0 ? depth_[i] : FAR_AWAY);
          farthest_point = std::max(farthest_point, measured_[i] != 0 ? depth_[i] : 0.0f);
        }
      block_nearest_[blockOf(u, v)] = nearest;
      block_points_[blockOf(u, v)] = aroundPoints(u, v, nearest_point, farthest_point);
    }
}

/// Around the corners of the block at the nearest and the farthest depth; where the nearest is the farther: nothing.
Sphere SeenSpace::aroundPoints(int u, int v, float nearest, float farthest) const
{
  if (nearest > farthest)
    return {Eigen::Vector3f::Zero(), -1};
  Eigen::AlignedBox3f box;
  for (const float depth : {nearest, farthest})
  {
    box.extend(Eigen::Vector3f(depth * ray(u, v)));
    box.extend(Eigen::Vector3f(depth * ray(u + BLOCK - 1, v + BLOCK - 1)));
  }
  return {box.center(), 0.5f * box.diagonal().norm()};
}

template <typename Points>
SeenSpace::Window SeenSpace::windowOf(const Points& points, float margin) const
{
  Eigen::AlignedBox2f window;
  for (const auto& point : points)
  {
    const Eigen::Vector3f p = point.template cast<float>();
    if (p.z() < MIN_DEPTH)
      return {0, 0, width_, height_};
    const float z = std::max(MIN_DEPTH, p.z() - margin);
    const Eigen::Vector2f around(margin * fx_ / z, margin * fy_ / z);
    const Eigen::Vector2f pixel(p.x() * fx_ / p.z() + cx_, p.y() * fy_ / p.z() + cy_);
    window.extend(Eigen::Vector2f(pixel - around));
    window.extend(Eigen::Vector2f(pixel + around));
  }
  const auto cut = [](float value, int size) {
    return static_cast<int>(std::clamp(value, -1.0f, static_cast<float>(size)));
  };
  return {std::max(0, cut(std::floor(window.min().x()), width_)),
          std::max(0, cut(std::floor(window.min().y()), height_)),
          std::min(width_, cut(std::ceil(window.max().x()), width_) + 1),
          std::min(height_, cut(std::ceil(window.max().y()), height_) + 1)};
}

struct SeenSpace::Search
{
  const SeenSpace& space;
  const BodySweep& body;
  const OwnPixels& target;
  /// For whichever pixels the less is allowed: few blocks have to be looked at more closely.
  const std::vector<float>& least_allowed;
  Encounter surface;
  Encounter unseen;

  void block(int u, int v)
  {
    Lanes lanes;
    for (int row = 0; row < BLOCK; ++row)
    {
      const std::size_t first = space.index(u, v + row);
      std::memcpy(lanes.depth[row], &space.depth_[first], sizeof(lanes.depth[row]));
      std::memcpy(lanes.allowed[row], &least_allowed[first], sizeof(lanes.allowed[row]));
    }
    const unsigned rows = meet(body.planes, space.ray(u, v), space.step_, LOOK_AHEAD, lanes);
    for (int row = 0; row < BLOCK; ++row)
      for (int k = 0; rows >> row & 1 && k < BLOCK; ++k)
        keep(lanes.distance[row][k], lanes.allowed[row][k], lanes.beyond[row][k], u + k, v + row);
  }

  void keep(float distance, float allowed, float beyond, int u, int v)
  {
    const std::size_t i = space.index(u, v);
    const bool is_near =
        distance < LOOK_AHEAD && space.measured_[i] != 0 && !(distance - space.surface_clearance_ >= surface.margin());
    const bool is_beyond = beyond > 0 && !(-beyond >= unseen.margin());
    if (!is_near && !is_beyond)
      return;
    const bool own = target.at(u, v);
    if (is_near && !own)
      keepWorse(surface, {distance, space.surface_clearance_, ObstacleKind::Surface, -1, space.pointAt(u, v)});
    const float reaches = allowed + beyond;
    const float farther = reaches - (own ? space.allowed_own_ : space.allowed_)[i];
    if (is_beyond && farther > 0)
      keepWorse(unseen, {-farther, 0, ObstacleKind::Unknown, -1, reaches * space.ray(u, v)});
  }
};

Encounter SeenSpace::nearest(const BodySweep& body, const OwnPixels& target) const
{
  Search search{*this, body, target, unseen_entry_ < shadow_entry_ ? allowed_ : allowed_own_, {}, {}};
  const Window w = windowOf(body.shape.vertices, LOOK_AHEAD);
  for (int v = w.top / BLOCK * BLOCK; v < w.bottom; v += BLOCK)
    for (int u = w.left / BLOCK * BLOCK; u < w.right; u += BLOCK * BLOCK)
    {
      const unsigned blocks = mayMeet(body.planes, ray(u, v), step_, LOOK_AHEAD, &block_nearest_[blockOf(u, v)]);
      for (int k = 0; blocks >> k != 0 && u + k * BLOCK < w.right; ++k)
        if (blocks >> k & 1)
          search.block(u + k * BLOCK, v);
    }
  // What was measured explains more than what was not, whose depth along the ray cannot be compared.
  return search.surface.free() && search.unseen.margin() < search.surface.margin() ? search.unseen : search.surface;
}

OwnPixels::OwnPixels(const SeenSpace& space, const DistanceField& field, const Eigen::AlignedBox3f& box_object,
                     const Pose& T_camera_object, float tolerance)
    : space_(space), field_(field), tolerance_(tolerance)
{
  const std::vector<Eigen::Vector3f> corners = cornersOf(box_object, Eigen::Isometry3f(T_camera_object.cast<float>()));
  const auto [front, back] = std::minmax_element(
      corners.begin(), corners.end(), [](const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return a.z() < b.z(); });
  nearest_ = front->z() - tolerance;
  farthest_ = back->z() + tolerance;
  window_ = space.windowOf(corners, tolerance);
  const Eigen::Isometry3f T_object(T_camera_object.inverse().cast<float>());
  camera_ = T_object.translation();
  right_ = T_object.linear().col(0) * space.step_.x();
  down_ = T_object.linear().col(1) * space.step_.y();
  corner_ = T_object.linear() * space.ray(0, 0);
}

bool OwnPixels::at(int u, int v) const
{
  if (!window_.contains(u, v))
    return false;
  const std::size_t pixel = space_.index(u, v);
  if (space_.measured_[pixel] != 0)
    return isOnSurface(pixel, u, v);
  const std::int32_t end = space_.hidden_by_[pixel];
  return end >= 0 && isOnSurface(static_cast<std::size_t>(end), end % space_.stride_, end / space_.stride_);
}

bool OwnPixels::isOnSurface(std::size_t pixel, int u, int v) const
{
  const float depth = space_.depth_[pixel];
  if (depth < nearest_ || depth > farthest_)
    return false;
  const Eigen::Vector3f ray = corner_ + static_cast<float>(u) * right_ + static_cast<float>(v) * down_;
  return std::abs(field_.at(camera_ + depth * ray)) <= tolerance_;
}
}  // namespace bin_picking
