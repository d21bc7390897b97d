// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "seen_space.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "sweep_lanes.hpp"

namespace bin_picking
{
namespace
{
static_assert(BLOCK == 8, "OwnPixels has a bit for each pixel of a row of a block");

constexpr float FAR_AWAY = 1e4f;     // metres: free all along the ray; finite, so that products stay numbers
constexpr float MIN_DEPTH = 0.05f;   // metres: what is nearer to the camera has no place in the picture
constexpr double MAX_EXTENSION = 2;  // of the picture's size, to either side

int wholeBlocks(int pixels) { return (pixels + BLOCK - 1) / BLOCK * BLOCK; }

/// Where the ray enters the inside of the bin, through its rim or behind a wall that hides it; 0 if the camera is in
/// there, FAR_AWAY if the ray passes by.
float depthAtRim(const Bin& bin, const Eigen::Vector3d& ray)
{
  const Pose T_bin_camera = bin.T_camera_bin.inverse();
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

SeenSpace::SeenSpace(const DepthGrid& measured, const Bin* bin, const ObstacleParameters& parameters)
    : surface_clearance_(static_cast<float>(parameters.surface_clearance)),
      unseen_entry_(static_cast<float>(parameters.unseen_entry)),
      shadow_entry_(static_cast<float>(parameters.shadow_entry))
{
  extendTo(measured, bin);
  bridgeGaps(measured, bin);
}

void SeenSpace::prepare(std::size_t step)
{
  if (step == 0)
    allowed_own_ = allowedDepth(shadow_entry_);
  else
    allowed_ = allowedDepth(unseen_entry_);
  if (step == 1)
    findBlockMinima();
}

void SeenSpace::extendTo(const DepthGrid& measured, const Bin* bin)
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
  for (int v = 0; v < measured.height; ++v)
    for (int u = 0; u < measured.width; ++u)
      if (measured.valid(measured.index(u, v)))
      {
        depth_[index(left_ + u, top_ + v)] = measured.z[static_cast<std::size_t>(measured.index(u, v))];
        measured_[index(left_ + u, top_ + v)] = 1;
      }
}

void SeenSpace::bridgeGaps(const DepthGrid& measured, const Bin* bin)
{
  // Of each row and column the first and the last measured pixel; on the way, what lies between two is bridged.
  std::vector<Ends> columns(static_cast<std::size_t>(measured.width));
  std::vector<Ends> rows(static_cast<std::size_t>(measured.height));
  for (int v = 0; v < measured.height; ++v)
    for (int u = 0; u < measured.width; ++u)
    {
      const std::size_t i = index(left_ + u, top_ + v);
      if (measured_[i] == 0)
        continue;
      bridgeTo(i, 1, rows[static_cast<std::size_t>(v)]);
      bridgeTo(i, static_cast<std::size_t>(stride_), columns[static_cast<std::size_t>(u)]);
    }
  for (int v = 0; v < measured.height; ++v)
    for (int u = 0; u < measured.width; ++u)
    {
      const std::size_t i = index(left_ + u, top_ + v);
      if (depth_[i] == FAR_AWAY)
        for (const Ends& ends : {rows[static_cast<std::size_t>(v)], columns[static_cast<std::size_t>(u)]})
          if (ends.any)
            offer(i, depth_[i < ends.first ? ends.first : ends.last], i < ends.first ? ends.first : ends.last);
    }
  if (!bin)
    return;
  for (int v = 0; v < height_; ++v)
    for (int u = 0; u < width_; ++u)
      if (depth_[index(u, v)] == FAR_AWAY)
        depth_[index(u, v)] = depthAtRim(*bin, ray(u, v).cast<double>());
}

/// The nearer of what is said of a pixel remains.
void SeenSpace::offer(std::size_t pixel, float depth, std::size_t hidden_by)
{
  if (depth >= depth_[pixel])
    return;
  depth_[pixel] = depth;
  hidden_by_[pixel] = static_cast<std::int32_t>(hidden_by);
}

/// A straight line from the last measured pixel of a row or column to the next.
void SeenSpace::bridgeTo(std::size_t next, std::size_t step, Ends& ends)
{
  const std::size_t last = ends.any ? ends.last : next;
  const std::size_t count = (next - last) / step;
  const float a = depth_[last];
  const float b = depth_[next];
  for (std::size_t k = 1; k < count; ++k)
  {
    // Along a straight line in space the inverse of the depth is linear in the picture.
    const float share = static_cast<float>(k) / static_cast<float>(count);
    offer(last + k * step, a * b / (b + share * (a - b)), a < b ? last : next);
  }
  ends = {true, ends.any ? ends.first : next, next};
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

void SeenSpace::findBlockMinima()
{
  const int across = stride_ / BLOCK;
  const int down = static_cast<int>(depth_.size()) / stride_ / BLOCK;
  block_nearest_.assign(static_cast<std::size_t>(across * down), FAR_AWAY);
  for (int v = 0; v < down * BLOCK; ++v)
    for (int u = 0; u < stride_; ++u)
    {
      float& nearest = block_nearest_[static_cast<std::size_t>(v / BLOCK * across + u / BLOCK)];
      nearest = std::min(nearest, depth_[index(u, v)]);
    }
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

OwnPixels SeenSpace::ownPixels(const DistanceField& field, const Eigen::AlignedBox3f& box_object,
                               const Pose& T_camera_object, float tolerance) const
{
  const std::vector<Eigen::Vector3f> corners = cornersOf(box_object, Eigen::Isometry3f(T_camera_object.cast<float>()));
  const auto [front, back] = std::minmax_element(
      corners.begin(), corners.end(), [](const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return a.z() < b.z(); });
  const float nearest = front->z() - tolerance;
  const float farthest = back->z() + tolerance;
  // From pixels to rays in the part's frame, since each is only asked once.
  const Eigen::Isometry3f T_object(T_camera_object.inverse().cast<float>());
  const Eigen::Vector3f camera = T_object.translation();
  const Eigen::Vector3f right = T_object.linear().col(0) * step_.x();
  const Eigen::Vector3f down = T_object.linear().col(1) * step_.y();
  const Eigen::Vector3f corner = T_object.linear() * ray(0, 0);
  const auto isOwn = [&](std::size_t i, int u, int v) {
    const float depth = depth_[i];
    if (depth < nearest || depth > farthest)
      return false;
    const Eigen::Vector3f ray_object = corner + static_cast<float>(u) * right + static_cast<float>(v) * down;
    return std::abs(field.at(camera + depth * ray_object)) <= tolerance;
  };
  const Window w = windowOf(corners, tolerance);
  OwnPixels own(w.left, w.top, w.right, w.bottom);
  for (int v = w.top; v < w.bottom; ++v)
    for (int u = w.left; u < w.right; ++u)
      if (measured_[index(u, v)] != 0 && isOwn(index(u, v), u, v))
        own.set(u, v);
  // Of what is hidden, many pixels have the same end of a bridge: most of these are known by now.
  for (int v = w.top; v < w.bottom; ++v)
    for (int u = w.left; u < w.right; ++u)
    {
      const std::int32_t end = hidden_by_[index(u, v)];
      if (end < 0)
        continue;
      const int x = end % stride_;
      const int y = end / stride_;
      const bool inside = x >= w.left && x < w.right && y >= w.top && y < w.bottom;
      if (inside ? own.at(x, y) : isOwn(static_cast<std::size_t>(end), x, y))
        own.set(u, v);
    }
  return own;
}

/// Whether the body, LOOK_AHEAD larger, reaches as far as `nearest` on any ray of a block. By the block's corners:
/// along a line in the picture the inverse depth of a plane is linear.
bool SeenSpace::mayMeet(const Planes& planes, int u, int v, float nearest) const
{
  const std::array<Eigen::Vector3f, 4> rays = {ray(u, v), ray(u + BLOCK - 1, v), ray(u, v + BLOCK - 1),
                                               ray(u + BLOCK - 1, v + BLOCK - 1)};
  float leaves = FAR_AWAY;
  float enters = 0;
  for (const Eigen::Vector4f& plane : planes)
  {
    const Eigen::Vector3f n = plane.head<3>();
    const Eigen::Array4f along(n.dot(rays[0]), n.dot(rays[1]), n.dot(rays[2]), n.dot(rays[3]));
    const float offset = LOOK_AHEAD - plane.w();
    if (along.minCoeff() > 0)
      leaves = std::min(leaves, offset > 0 ? offset / along.minCoeff() : offset / along.maxCoeff());
    else if (along.maxCoeff() < 0)
      enters = std::max(enters, offset > 0 ? 0.0f : offset / along.minCoeff());
  }
  return leaves >= nearest && enters <= leaves;
}

struct SeenSpace::Search
{
  const SeenSpace& space;
  const BodySweep& body;
  const OwnPixels& target;
  Encounter surface;
  Encounter unseen;

  void block(int u, int v)
  {
    if (!space.mayMeet(body.planes, u, v,
                       space.block_nearest_[static_cast<std::size_t>(v / BLOCK * (space.stride_ / BLOCK) + u / BLOCK)]))
      return;
    Lanes lanes;
    std::array<std::uint8_t, BLOCK> own;
    for (int row = 0; row < BLOCK; ++row)
      own[static_cast<std::size_t>(row)] = fill(lanes, row, u, v + row);
    const unsigned rows = meet(body.planes, space.ray(u, v), space.step_, LOOK_AHEAD, lanes);
    for (int row = 0; row < BLOCK; ++row)
      if (rows >> row & 1)
        keep(lanes, row, own[static_cast<std::size_t>(row)], u, v + row);
  }

  /// \return the target's own pixels
  std::uint8_t fill(Lanes& lanes, int row, int u, int v) const
  {
    const std::size_t first = space.index(u, v);
    const std::uint8_t own = target.inBlock(u / BLOCK, v);
    std::memcpy(lanes.depth[row], &space.depth_[first], sizeof(lanes.depth[row]));
    std::memcpy(lanes.allowed[row], &space.allowed_[first], sizeof(lanes.allowed[row]));
    for (int k = 0; own != 0 && k < BLOCK; ++k)
      if (own >> k & 1)
        lanes.allowed[row][k] = space.allowed_own_[first + static_cast<std::size_t>(k)];
    return own;
  }

  void keep(const Lanes& lanes, int row, std::uint8_t own, int u, int v)
  {
    const std::size_t first = space.index(u, v);
    for (int k = 0; k < BLOCK; ++k)
    {
      const float beyond = lanes.beyond[row][k];
      const float distance = lanes.distance[row][k];
      if (beyond > 0)
        keepWorse(unseen,
                  {-beyond, 0, ObstacleKind::Unknown, -1, (lanes.allowed[row][k] + beyond) * space.ray(u + k, v)});
      if (distance < LOOK_AHEAD && space.measured_[first + static_cast<std::size_t>(k)] != 0 && !(own >> k & 1))
        keepWorse(surface, {distance, space.surface_clearance_, ObstacleKind::Surface, -1, space.pointAt(u + k, v)});
    }
  }
};

Encounter SeenSpace::nearest(const BodySweep& body, const OwnPixels& target) const
{
  Search search{*this, body, target, {}, {}};
  const Window w = windowOf(body.shape.vertices, LOOK_AHEAD);
  const float deepest = body.box.max().z() + LOOK_AHEAD;
  for (int v = w.top / BLOCK * BLOCK; v < w.bottom; v += BLOCK)
    for (int u = w.left / BLOCK * BLOCK; u < w.right; u += BLOCK)
      if (block_nearest_[static_cast<std::size_t>(v / BLOCK * (stride_ / BLOCK) + u / BLOCK)] <= deepest)
        search.block(u, v);
  // What was measured explains more than what was not, whose depth along the ray cannot be compared.
  return search.surface.free() && search.unseen.margin() < search.surface.margin() ? search.unseen : search.surface;
}
}  // namespace bin_picking
