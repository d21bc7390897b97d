// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "peer_data.hpp"

namespace bin_picking::peers
{
/// A simple test of poses against the depth image for programs that have none, so that their poses of a whole bin can
/// be ranked: of what the camera would see of the part, how much lies within 2 mm of the measured surface, and how much
/// hangs free before it. Rejects poses with little support and those that share most of it with a better one.
std::vector<PeerPose> checkedByDepth(const std::vector<PeerPose>& poses, const PeerModel& model,
                                     const PeerScene& scene);
}  // namespace bin_picking::peers
