// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "ray_scene.hpp"

#include <tbb/task_arena.h>

#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <utility>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking::simulation
{
namespace
{
/// The plane's depth replaces Embree's unless they differ by more than this share: a ray along the triangle.
constexpr double PLANE_TOLERANCE = 1e-3;

RTCRay makeRay(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float far)
{
  RTCRay ray{};
  ray.org_x = origin.x();
  ray.org_y = origin.y();
  ray.org_z = origin.z();
  ray.dir_x = direction.x();
  ray.dir_y = direction.y();
  ray.dir_z = direction.z();
  ray.tfar = far;
  ray.mask = std::numeric_limits<unsigned>::max();
  return ray;
}

bool isBlocked(RTCScene scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, float far)
{
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray = makeRay(origin.cast<float>(), direction.cast<float>(), far);
  rtcOccluded1(scene, &context, &ray);
  return ray.tfar < 0;  // how Embree says yes
}

/// One thread builds the search tree, so that it is the same every time.
void commit(RTCScene scene)
{
  tbb::task_arena(1).execute([scene] {
    const FlushDenormals flush;
    rtcCommitScene(scene);
  });
}

void checkObject(const SceneObject& object, std::size_t index)
{
  const std::string which = "object " + std::to_string(index) + " of the virtual scene ";
  if (!object.mesh || object.mesh->empty())
    throw ParameterError(which + "has no triangles; give it a mesh with at least one");
  for (const auto& triangle : object.mesh->triangles)
    for (const std::uint32_t vertex : triangle)
      if (vertex >= object.mesh->vertices.size())
        throw ParameterError(which + "has a triangle with vertex " + std::to_string(vertex) +
                             ", but the mesh has only " + std::to_string(object.mesh->vertices.size()) +
                             "; load the mesh again");
  if (!object.T_camera_object.matrix().allFinite())
    throw ParameterError(which + "has a pose that is not finite; give it a rotation and a position in metres");
}
}  // namespace

#if defined(__SSE__)
FlushDenormals::FlushDenormals() : before_(_mm_getcsr())
{
  constexpr unsigned FLUSH_TO_ZERO = 0x8000;
  constexpr unsigned DENORMALS_ARE_ZERO = 0x0040;
  _mm_setcsr(before_ | FLUSH_TO_ZERO | DENORMALS_ARE_ZERO);
}

FlushDenormals::~FlushDenormals() { _mm_setcsr(before_); }
#else
FlushDenormals::FlushDenormals() : before_(0) {}
FlushDenormals::~FlushDenormals() = default;
#endif

// Without the device's option "threads=1": that one holds back every other use of TBB in this process.
RayScene::RayScene() : device_(rtcNewDevice(nullptr)) { throwOnError("starting"); }
RayScene::~RayScene() = default;

void RayScene::throwOnError(const char* doing) const
{
  const RTCError error = rtcGetDeviceError(device_.get());
  if (device_ && error == RTC_ERROR_NONE)
    return;
  throw Error("the ray tracer Embree failed with error " + std::to_string(static_cast<int>(error)) + " while " + doing +
              "; 3 is out of memory (fewer or coarser meshes help), 4 is a processor without SSE2, otherwise install "
              "libembree3 again");
}

const RayScene::MeshScene& RayScene::shapeOf(const SceneObject& object)
{
  const auto known = shapes_.find(object.mesh.get());
  if (known != shapes_.end())
    return known->second;
  MeshScene shape;
  const TriangleMesh& mesh = *object.mesh;
  shape.mesh = object.mesh;
  shape.padded_vertices.reserve(3 * mesh.vertices.size() + 1);
  for (const Eigen::Vector3f& vertex : mesh.vertices)
    shape.padded_vertices.insert(shape.padded_vertices.end(), {vertex.x(), vertex.y(), vertex.z()});
  shape.padded_vertices.push_back(0);
  RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, shape.padded_vertices.data(), 0,
                             3 * sizeof(float), mesh.vertices.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             3 * sizeof(std::uint32_t), mesh.triangles.size());
  rtcCommitGeometry(geometry);
  shape.scene.reset(rtcNewScene(device_.get()));
  rtcSetSceneFlags(shape.scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(shape.scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  commit(shape.scene.get());
  throwOnError("building the search tree of a mesh");
  return shapes_.emplace(object.mesh.get(), std::move(shape)).first->second;
}

void RayScene::addInstance(const SceneObject& object)
{
  const MeshScene& shape = shapeOf(object);
  RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, shape.scene.get());
  const Eigen::Matrix4f transform = object.T_camera_object.matrix().cast<float>();
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, transform.data());
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene_.get(), geometry, static_cast<unsigned>(instances_.size()));
  rtcReleaseGeometry(geometry);
  const Pose T_object_camera = object.T_camera_object.inverse();
  instances_.push_back({&shape, T_object_camera.linear(), T_object_camera.translation()});
}

void RayScene::setObjects(const std::vector<SceneObject>& objects)
{
  for (std::size_t i = 0; i < objects.size(); ++i)
    checkObject(objects[i], i);
  instances_.clear();
  scene_.reset(rtcNewScene(device_.get()));
  for (auto shape = shapes_.begin(); shape != shapes_.end();)
    shape = shape->second.mesh.use_count() == 1 ? shapes_.erase(shape) : std::next(shape);
  rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
  for (const SceneObject& object : objects)
    addInstance(object);
  commit(scene_.get());
  throwOnError("building the search tree of the scene");
}

RayHit RayScene::fromCamera(const Eigen::Vector3d& direction) const
{
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit query{};
  query.ray = makeRay(Eigen::Vector3f::Zero(), direction.cast<float>(), std::numeric_limits<float>::infinity());
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene_.get(), &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID)
    return {};
  return onPlane(static_cast<int>(query.hit.instID[0]), query.hit.primID, direction,
                 static_cast<double>(query.ray.tfar));
}

RayHit RayScene::onPlane(int object, unsigned triangle, const Eigen::Vector3d& direction, double fallback_depth) const
{
  const Instance& instance = instances_[static_cast<std::size_t>(object)];
  const TriangleMesh& mesh = *instance.shape->mesh;
  const auto& corners = mesh.triangles[triangle];
  const Eigen::Vector3d a = mesh.vertices[corners[0]].cast<double>();
  const Eigen::Vector3d b = mesh.vertices[corners[1]].cast<double>();
  const Eigen::Vector3d c = mesh.vertices[corners[2]].cast<double>();
  const Eigen::Vector3d direction_object = instance.R_object_camera * direction;
  Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
  if (normal.dot(direction_object) > 0)
    normal = -normal;
  const double depth = normal.dot(a - instance.camera_object) / normal.dot(direction_object);
  RayHit hit;
  hit.object = object;
  hit.depth = std::abs(depth - fallback_depth) <= PLANE_TOLERANCE * fallback_depth ? depth : fallback_depth;
  hit.normal = instance.R_object_camera.transpose() * normal;
  return hit;
}

bool RayScene::unobstructed(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const
{
  return !isBlocked(scene_.get(), from, to - from, 1.0f);
}

bool RayScene::meetsAlone(int object, const Eigen::Vector3d& direction) const
{
  const Instance& instance = instances_[static_cast<std::size_t>(object)];
  return isBlocked(instance.shape->scene.get(), instance.camera_object, instance.R_object_camera * direction,
                   std::numeric_limits<float>::infinity());
}
}  // namespace bin_picking::simulation
