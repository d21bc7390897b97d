// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "point_scene.hpp"

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/kd_tree.hpp"
#include "bin_picking_perception/model/depth_renderer.hpp"

namespace bin_picking::paper
{
namespace
{
namespace fs = std::filesystem;

constexpr double CAMERA_DISTANCE = 1.2;  // metres from the middle of a scene
constexpr double MESH_SPACING = 0.001;   // of the points that are drawn from a mesh
const PinholeCamera CAMERA{1100, 1100, 320, 320};
constexpr int PICTURE = 640;  // pixels along both edges

double uniform(std::mt19937& random) { return static_cast<double>(random()) / 4294967296.0; }

double gaussian(std::mt19937& random)
{
  const double u = 1 - uniform(random);
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * M_PI * uniform(random));
}

Eigen::Matrix3d randomRotation(std::mt19937& random)
{
  const double w = gaussian(random);
  const double x = gaussian(random);
  const double y = gaussian(random);
  const double z = gaussian(random);
  return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
}

Eigen::Vector3d middleOf(const OrientedPoints& surface)
{
  Eigen::AlignedBox3f box;
  for (const auto& p : surface.points)
    box.extend(p);
  return box.center().cast<double>();
}

double meshResolution(const std::vector<Eigen::Vector3f>& points)
{
  constexpr float SEARCHED = 0.004f;
  const KdTree tree(points);
  std::vector<int> neighbours;
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < points.size(); i += std::max<std::size_t>(1, points.size() / 500))
  {
    float nearest = SEARCHED;
    tree.radiusSearch(points[i], SEARCHED, neighbours);
    for (const int n : neighbours)
      if (static_cast<std::size_t>(n) != i)
        nearest = std::min(nearest, (points[static_cast<std::size_t>(n)] - points[i]).norm());
    sum += static_cast<double>(nearest);
    ++count;
  }
  return sum / count;
}

/// Under a name of its own first: experiments that run at once write the same file.
void writePly(const fs::path& file, const OrientedPoints& points)
{
  const fs::path unfinished = file.string() + "." + std::to_string(getpid());
  std::ofstream out(unfinished);
  out << "ply\nformat ascii 1.0\nelement vertex " << points.size();
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"})
    out << "\nproperty float " << name;
  out << "\nend_header\n";
  out.precision(9);
  for (std::size_t i = 0; i < points.size(); ++i)
    out << points.points[i].transpose() << " " << points.normals[i].transpose() << "\n";
  out.close();
  if (!out)
    throw FileError("The scaled model " + file.string() + " cannot be written; is there room?");
  fs::rename(unfinished, file);
}

/// Pose that puts the middle of an object to a place.
Pose placed(const PointObject& object, const Eigen::Matrix3d& rotation, const Eigen::Vector3d& place)
{
  Pose T = Pose::Identity();
  T.linear() = rotation;
  T.translation() = place - rotation * middleOf(object.surface);
  return T;
}

/// The searched object in the middle, the others around it, every second one nearer to the camera: it hides a part.
std::vector<Pose> place(const std::vector<PointObject>& objects, std::mt19937& random)
{
  std::vector<Pose> poses;
  const double size = boundingBoxDiagonal(objects.front().surface.points);
  const double first = 2 * M_PI * uniform(random);
  for (std::size_t k = 0; k < objects.size(); ++k)
  {
    const Eigen::Matrix3d rotation = randomRotation(random);
    Eigen::Vector3d at(0, 0, CAMERA_DISTANCE);
    if (k > 0)
    {
      const double angle = first + 2 * M_PI * static_cast<double>(k) / static_cast<double>(objects.size() - 1);
      const double away = size * (0.25 + 0.3 * uniform(random));
      const double nearer = size * (k % 2 == 1 ? -0.2 - 0.4 * uniform(random) : 0.3 * uniform(random));
      at += Eigen::Vector3d(away * std::cos(angle), away * std::sin(angle), nearer);
    }
    poses.push_back(placed(objects[k], rotation, at));
  }
  return poses;
}

/// Indices of the points of a moved surface that the camera sees, given the nearest depths of all.
std::vector<int> seenPoints(const OrientedPoints& moved, const DepthRenderer& nearest, double radius)
{
  std::vector<int> seen;
  for (std::size_t i = 0; i < moved.size(); ++i)
  {
    const Eigen::Vector3f& p = moved.points[i];
    const float cosine = -moved.normals[i].dot(p.normalized());
    if (cosine < 0.15f)
      continue;
    const Eigen::Vector2d at = CAMERA.project(p.cast<double>());
    const int u = static_cast<int>(std::lround(at.x()));
    const int v = static_cast<int>(std::lround(at.y()));
    if (u < 0 || v < 0 || u >= PICTURE || v >= PICTURE)
      continue;
    const float depth = nearest.depth()[static_cast<std::size_t>(v * PICTURE + u)];
    if (p.z() <= depth + static_cast<float>(2.5 * radius))
      seen.push_back(static_cast<int>(i));
  }
  return seen;
}

void addNoise(OrientedPoints& points, double sigma, std::mt19937& random)
{
  for (auto& p : points.points)
    for (int i = 0; i < 3; ++i)
      p[i] += static_cast<float>(sigma * gaussian(random));
}

void append(OrientedPoints& all, const OrientedPoints& more)
{
  all.points.insert(all.points.end(), more.points.begin(), more.points.end());
  all.normals.insert(all.normals.end(), more.normals.begin(), more.normals.end());
}

double discRadius(const PointObject& object) { return std::max(1.2 * object.resolution, 0.0008); }
}  // namespace

PointObject readObject(const Json& json, const std::string& folder)
{
  PointObject object;
  if (json.contains("part"))
  {
    object.part = loadPart(json.at("part").get<std::string>());
    object.surface = sampleSurface(loadMesh(object.part.mesh_file, object.part.mesh_unit), MESH_SPACING, 1);
    object.resolution = meshResolution(object.surface.points);
    return object;
  }
  const auto file = json.at("file").get<std::string>();
  const LengthUnit unit = parseLengthUnit(json.value("unit", "m"));
  object.part.name = json.at("name").get<std::string>();
  object.part.mesh_file = file;
  object.part.mesh_unit = unit;
  object.surface = loadOrientedPoints(file, unit);
  if (json.contains("diagonal"))
  {
    const double scale = json.at("diagonal").get<double>() / boundingBoxDiagonal(object.surface.points);
    for (auto& p : object.surface.points)
      p *= static_cast<float>(scale);
    object.part.mesh_file = (fs::path(folder) / (object.part.name + ".ply")).string();
    object.part.mesh_unit = LengthUnit::Metre;
    writePly(object.part.mesh_file, object.surface);
  }
  object.resolution = meshResolution(object.surface.points);
  return object;
}

SceneKind parseSceneKind(const std::string& name)
{
  for (const auto& [known, kind] : {std::pair<const char*, SceneKind>{"whole", SceneKind::Whole},
                                    {"view", SceneKind::View},
                                    {"clutter", SceneKind::Clutter}})
    if (name == known)
      return kind;
  throw ParameterError("the kind of scene is '" + name + "', but it must be whole, view or clutter");
}

PointScene makePointScene(const std::vector<PointObject>& objects, SceneKind kind, double noise, std::uint32_t seed)
{
  std::mt19937 random(seed);
  const std::vector<Pose> poses = place(objects, random);
  const std::size_t count = kind == SceneKind::Clutter ? objects.size() : 1;
  const double sigma = noise * objects.front().resolution;
  PointScene scene;
  scene.T_camera_object = poses.front();
  DepthRenderer alone(PICTURE, PICTURE, CAMERA);
  DepthRenderer together(PICTURE, PICTURE, CAMERA);
  alone.draw(objects.front().surface, poses.front(), discRadius(objects.front()), 0);
  for (std::size_t k = 0; k < count && kind != SceneKind::Whole; ++k)
    together.draw(objects[k].surface, poses[k], discRadius(objects[k]), static_cast<std::int32_t>(k));
  for (std::size_t k = 0; k < count; ++k)
  {
    OrientedPoints moved = transformed(objects[k].surface, poses[k]);
    const std::size_t all = moved.size();
    if (kind != SceneKind::Whole)
    {
      if (k == 0)
        scene.visible_share = 1 / static_cast<double>(seenPoints(moved, alone, discRadius(objects[k])).size());
      moved = select(moved, seenPoints(moved, together, discRadius(objects[k])));
    }
    addNoise(moved, sigma, random);
    if (k == 0)
    {
      scene.of_object = moved.points;
      scene.seen_share = static_cast<double>(moved.size()) / static_cast<double>(all);
      scene.visible_share = kind == SceneKind::Whole ? 1 : scene.visible_share * static_cast<double>(moved.size());
    }
    append(scene.points, moved);
  }
  return scene;
}

PointScene readPointScene(const Json& json, const PointObject& object)
{
  PointScene scene;
  scene.points = loadOrientedPoints(json.at("file").get<std::string>(), parseLengthUnit(json.value("unit", "m")));
  const auto truth = json.at("truth").get<std::string>();
  std::ifstream in(truth);
  Eigen::Matrix4d T;
  for (int i = 0; i < 16; ++i)
    in >> T(i / 4, i % 4);
  if (!in)
    throw FileError("The pose " + truth + " is not a matrix of four rows of four numbers.");
  scene.T_camera_object.linear() =
      Eigen::Quaterniond(Eigen::Matrix3d(T.topLeftCorner<3, 3>())).normalized().toRotationMatrix();
  scene.T_camera_object.translation() = T.topRightCorner<3, 1>() / 1000;
  // What of the scan is the object: the points that lie on it at the given pose.
  constexpr float NEAR = 0.005f;
  const KdTree tree(transformed(object.surface, scene.T_camera_object).points);
  for (const auto& p : scene.points.points)
    if (tree.nearest(p, NEAR).index >= 0)
      scene.of_object.push_back(p);
  const KdTree measured(scene.points.points);
  std::size_t seen = 0;
  for (const auto& p : transformed(object.surface, scene.T_camera_object).points)
    seen += measured.nearest(p, NEAR).index >= 0 ? 1 : 0;
  scene.seen_share = static_cast<double>(seen) / static_cast<double>(object.surface.size());
  scene.visible_share = scene.seen_share;
  return scene;
}
}  // namespace bin_picking::paper
