// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <embree3/rtcore.h>

#include <map>
#include <memory>
#include <vector>

#include "sensor.hpp"

namespace bin_picking::simulation
{
/// Where a ray meets a surface first.
struct RayHit
{
  int object = -1;                                   ///< -1: it meets none
  double depth = 0;                                  ///< the ray's parameter: point = origin + depth * direction
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit length, towards the ray's origin
};

/// Objects to be asked for what a ray meets; Embree's search trees of the meshes are kept while somebody holds the
/// mesh. Questions may come from several threads at once, setObjects() not.
class RayScene
{
public:
  /// \throws Error Embree does not start on this machine
  RayScene();
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  /// \throws ParameterError an object without triangles, with an index past the vertices, or a pose that is not finite
  void setObjects(const std::vector<SceneObject>& objects);

  /// The first surface on the ray from the camera (the origin). The depth is exact to the rounding of a double: the
  /// triangle comes from Embree's single precision, the point from the triangle's plane.
  RayHit fromCamera(const Eigen::Vector3d& direction) const;
  /// Whether nothing stands between the two points, their ends apart.
  bool unobstructed(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;
  /// Whether the ray from the camera would meet this object if it were alone.
  bool meetsAlone(int object, const Eigen::Vector3d& direction) const;

private:
  struct Release
  {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  using Device = std::unique_ptr<RTCDeviceTy, Release>;
  using Scene = std::unique_ptr<RTCSceneTy, Release>;

  struct MeshScene
  {
    std::shared_ptr<const TriangleMesh> mesh;
    std::vector<float> padded_vertices;  ///< Embree reads 16 bytes at every vertex
    Scene scene;
  };
  struct Instance
  {
    const MeshScene* shape = nullptr;
    Eigen::Matrix3d R_object_camera;
    Eigen::Vector3d camera_object;  ///< the camera's place
  };

  const MeshScene& shapeOf(const SceneObject& object);
  void addInstance(const SceneObject& object);
  RayHit onPlane(int object, unsigned triangle, const Eigen::Vector3d& direction, double fallback_depth) const;
  void throwOnError(const char* doing) const;

  Device device_;
  std::map<const TriangleMesh*, MeshScene> shapes_;
  std::vector<Instance> instances_;
  Scene scene_;
};

/// Embree expects that numbers too small to matter are zero: on for the lifetime of this, in this thread.
class FlushDenormals
{
public:
  FlushDenormals();
  ~FlushDenormals();
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

private:
  unsigned before_;
};
}  // namespace bin_picking::simulation
