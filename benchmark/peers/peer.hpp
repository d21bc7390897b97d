// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bin_picking_perception/evaluation/evaluation_dataset.hpp"
#include "bin_picking_perception/model/mesh.hpp"
#include "bin_picking_perception/model/part.hpp"

namespace bin_picking::peers
{
/// A part as every program gets it.
struct PeerModel
{
  PartDefinition definition;
  TriangleMesh mesh;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    ///< bounding box, metres
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< its middle
  double diameter = 0;                               ///< metres
  OrientedPoints surface;                            ///< about 1 % of the diameter apart
};

/// A scan as every program gets it.
struct PeerScene
{
  pcl::PointCloud<pcl::PointXYZ> cloud;  ///< as a driver hands it over; empty for depth pictures
  DepthGrid grid;                        ///< the same, or the depth picture
  OrientedPoints points;                 ///< of the region that is searched, with the normals that all programs share
  OrientedPoints
      fine;  ///< the same, averaged in cubes of 1 % of the diameter: what the peers' ICP and `ours, points only` get
  std::optional<Bin> bin;
  int max_poses = 1;       ///< that are wanted
  double max_seconds = 0;  ///< CPU time after which no further pose is begun
};

struct PeerPose
{
  Pose T_camera_object = Pose::Identity();
  double score = 0;  ///< larger is better; votes for the peers, what verification says for ours
};

/// Times are CPU seconds of the process, which other programs on the machine disturb less than they do wall time.
struct PeerResult
{
  std::vector<PeerPose> matched;  ///< before ICP; none if the program does not show them
  std::vector<PeerPose> poses;    ///< after ICP, best first
  double match_seconds = 0;
  double icp_seconds = 0;
  int scene_points = 0;  ///< that were matched
};

/// A program that finds a part in scans: trained once, then asked.
class Peer
{
public:
  virtual ~Peer() = default;

  /// \param step sampling as a share of the part's diameter; 0: as the program derives it itself
  virtual void train(const PeerModel& model, double step) = 0;
  virtual PeerResult find(const PeerScene& scene) = 0;
  virtual int modelPoints() const = 0;
  /// Whether what find() returns has been tested against the scan; else the benchmark's depth check does it.
  virtual bool verifies() const = 0;
};

std::unique_ptr<Peer> makeOpenCv();        ///< cv::ppf_match_3d
std::unique_ptr<Peer> makePcl();           ///< pcl::PPFRegistration
std::unique_ptr<Peer> makeOurs();          ///< Detector::detect on the organized cloud
std::unique_ptr<Peer> makeOursOnPoints();  ///< Detector::match on the points and normals that the peers' ICP gets

struct PeerProgram
{
  std::string key;   ///< in options and files
  std::string name;  ///< in tables
  std::unique_ptr<Peer> (*make)();
  bool own_step = false;  ///< derives its sampling itself
};

/// In the order of the tables. Ours, which times are compared with, is the first.
const std::vector<PeerProgram>& programs();
}  // namespace bin_picking::peers
