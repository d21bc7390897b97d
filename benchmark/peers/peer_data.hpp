// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstddef>

#include "peer.hpp"

namespace bin_picking::peers
{
/// CPU seconds that this process has used, all threads together.
double cpuSeconds();

/// Resident memory of this process and its peak since the last resetPeakMemory(), bytes.
struct Memory
{
  double resident = 0;
  double peak = 0;
};
Memory memory();
/// Gives unused heap back and forgets the peak so far.
void resetPeakMemory();

/// One point per cube of edge `edge`, the mean of its points; two where the cube holds both faces of a thin wall.
OrientedPoints sampledInCubes(const OrientedPoints& dense, double edge);

PeerModel makePeerModel(const PartDefinition& definition);

/// The scan with normals; with a bin only what lies in it, at half the pixels.
PeerScene loadPeerScene(const EvaluationScene& scene, const PeerModel& model);

/// Points of `points` (part frame) that the camera sees at a pose: they face it and nothing of the part hides them.
OrientedPoints seenPoints(const PeerModel& model, const OrientedPoints& points, const Pose& T_camera_object);

/// Scene points in the part's bounding box at a pose, grown by `margin`.
OrientedPoints nearPose(const OrientedPoints& scene, const PeerModel& model, const Pose& T_camera_object,
                        double margin);

/// The nearest rigid motion: OpenCV returns averaged quaternions that are none. Nothing if the matrix holds no
/// rotation.
std::optional<Pose> nearestRigid(const Eigen::Matrix4d& matrix);
}  // namespace bin_picking::peers
