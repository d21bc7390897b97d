// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "sensor.hpp"

#include <string>
#include <utility>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "ray_scene.hpp"
#include "sensor_effects.hpp"
#include "sensor_view.hpp"

namespace bin_picking::simulation
{
struct VirtualSensor::Impl
{
  Impl(const SensorParameters& sensor_parameters, int num_threads)
      : parameters(sensor_parameters), executor(num_threads)
  {}

  SensorParameters parameters;
  Executor executor;
  RayScene scene;
};

namespace
{
/// Writing a value back through its visitor checks its range.
SensorParameters checked(SensorParameters parameters)
{
  SensorParameters copy = parameters;
  for (const ParameterEntry& entry : listParameters(visitor(copy)))
    setParameter(visitor(copy), entry.path, entry.value);
  if (parameters.edges.window % 2 == 0)
    throw ParameterError("parameter 'edges/window' is " + std::to_string(parameters.edges.window) +
                         ", but a window has a middle pixel; give an odd number, at least 1");
  return parameters;
}

DepthGrid measure(const RayScene& scene, const EffectContext& context)
{
  Exposure exposure = expose(scene, context);
  const std::vector<float> edges = findEdges(context);
  const bool by_window = context.parameters.edges.window > 1;
  if (by_window)
    matchWindows(exposure, edges, context);
  losePixelsBesideEdges(exposure, edges, context);
  if (!by_window)
    mixAcrossEdges(exposure, edges, context);
  punchHoles(exposure, context);
  return digitize(exposure, context);
}
}  // namespace

VirtualSensor::VirtualSensor(const SensorParameters& parameters, int num_threads)
    : impl_(std::make_unique<Impl>(checked(parameters), num_threads))
{}

VirtualSensor::~VirtualSensor() = default;
VirtualSensor::VirtualSensor(VirtualSensor&&) noexcept = default;
VirtualSensor& VirtualSensor::operator=(VirtualSensor&&) noexcept = default;

Scan VirtualSensor::scan(const std::vector<SceneObject>& objects, std::uint32_t seed)
{
  impl_->scene.setObjects(objects);
  SensorView view = renderView(impl_->scene, impl_->parameters, impl_->executor);
  Scan scan;
  scan.grid = measure(impl_->scene, {view, impl_->parameters, impl_->executor, seed});
  scan.views = countPixels(impl_->scene, objects, view, scan.grid, impl_->executor);
  scan.labels = std::move(view.labels);
  return scan;
}

PinholeCamera VirtualSensor::camera() const { return cameraOf(impl_->parameters); }
const SensorParameters& VirtualSensor::parameters() const { return impl_->parameters; }
}  // namespace bin_picking::simulation
