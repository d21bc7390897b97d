// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "cloud_player.hpp"

#include <glob.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/io/pcd_io.h>
#include <pcl_conversions/pcl_conversions.h>
#include <ros/console.h>

#include <memory>
#include <utility>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parameters.hpp"
#include "parameter_tree.hpp"
#include "resource_path.hpp"

namespace bin_picking_ros
{
namespace
{
struct PlayerParameters
{
  std::string frame_id = "camera";
  double rate = 1.0;
  bool loop = true;

  void visit(bin_picking::ParameterVisitor& v)
  {
    v.field({"frame_id", "", "frame of the published clouds"}, frame_id, std::vector<std::string>{});
    v.field({"rate", "Hz", "clouds per second; 0: only when ~trigger is called", 0, 1000}, rate);
    v.field({"loop", "", "begin again after the last file"}, loop);
  }
};

PlayerParameters readPlayerParameters(const ros::NodeHandle& private_nh)
{
  PlayerParameters parameters;
  XmlRpc::XmlRpcValue tree;
  private_nh.getParam("", tree);
  if (tree.getType() == XmlRpc::XmlRpcValue::TypeStruct)
    for (auto& [name, value] : tree)
    {
      if (name == "files")
        continue;
      XmlRpc::XmlRpcValue single;
      single[name] = value;
      for (const auto& [path, text] : flatten(single))
        bin_picking::setParameter(bin_picking::visitor(parameters), path, text);
    }
  return parameters;
}

std::vector<std::string> readFiles(const ros::NodeHandle& private_nh)
{
  std::vector<std::string> patterns;
  std::string single;
  if (private_nh.getParam("files", single))
    patterns.push_back(single);
  else
    private_nh.getParam("files", patterns);
  if (patterns.empty())
    throw bin_picking::ParameterError("The parameter files is missing or empty; it must name PCD files or a pattern.");
  return expandFiles(patterns);
}

sensor_msgs::PointCloud2 readCloud(const std::string& file)
{
  pcl::PCLPointCloud2 cloud;
  if (pcl::io::loadPCDFile(file, cloud) < 0)
    throw bin_picking::FileError("The file " + file + " cannot be read as PCD.");
  sensor_msgs::PointCloud2 message;
  pcl_conversions::moveFromPCL(cloud, message);
  return message;
}
}  // namespace

std::vector<std::string> expandFiles(const std::vector<std::string>& patterns)
{
  std::vector<std::string> files;
  for (const std::string& pattern : patterns)
  {
    glob_t found{};
    const int failure = glob(resolveResource(pattern).c_str(), 0, nullptr, &found);
    const std::unique_ptr<glob_t, decltype(&globfree)> owner(&found, &globfree);
    if (failure != 0)
      throw bin_picking::FileError("No file fits " + pattern + ".");
    files.insert(files.end(), found.gl_pathv, found.gl_pathv + found.gl_pathc);
  }
  return files;
}

CloudPlayer::CloudPlayer(ros::NodeHandle nh, ros::NodeHandle private_nh) : files_(readFiles(private_nh))
{
  const PlayerParameters parameters = readPlayerParameters(private_nh);
  frame_id_ = parameters.frame_id;
  loop_ = parameters.loop;
  publisher_ = nh.advertise<sensor_msgs::PointCloud2>("points", 1);
  trigger_ = private_nh.advertiseService("trigger", &CloudPlayer::trigger, this);
  if (parameters.rate > 0)
    timer_ = nh.createWallTimer(ros::WallDuration(1.0 / parameters.rate),
                                [this](const ros::WallTimerEvent&) { publishNext(); });
  loader_ = std::thread([this] { loadAll(); });
}

CloudPlayer::~CloudPlayer()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  loader_.join();
}

void CloudPlayer::loadAll()
{
  for (const std::string& file : files_)
  {
    try
    {
      sensor_msgs::PointCloud2 cloud = readCloud(file);
      cloud.header.frame_id = frame_id_;
      const std::lock_guard<std::mutex> lock(mutex_);
      if (stop_)
        return;
      clouds_.push_back(std::move(cloud));
    }
    catch (const std::exception& error)
    {
      ROS_ERROR_STREAM("The cloud player publishes nothing. " << error.what());
      const std::lock_guard<std::mutex> lock(mutex_);
      status_ = error.what();
      return;
    }
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  prepareNext();
}

void CloudPlayer::prepareNext()
{
  if (next_index_ == clouds_.size() && loop_)
    next_index_ = 0;
  if (next_index_ == clouds_.size())
    status_ = "All " + std::to_string(clouds_.size()) + " clouds have been published.";
  else
    next_ = boost::make_shared<sensor_msgs::PointCloud2>(clouds_[next_index_]);
}

std_srvs::Trigger::Response CloudPlayer::publishNext()
{
  const std::lock_guard<std::mutex> lock(mutex_);
  std_srvs::Trigger::Response response;
  response.success = static_cast<std::uint8_t>(next_ != nullptr);
  response.message = status_;
  if (!next_)
    return response;
  response.message = "Published " + files_[next_index_] + ".";
  const sensor_msgs::PointCloud2Ptr cloud = std::exchange(next_, nullptr);
  cloud->header.stamp = ros::Time::now();
  publisher_.publish(cloud);
  ++next_index_;
  prepareNext();
  return response;
}

bool CloudPlayer::trigger(std_srvs::Trigger::Request&, std_srvs::Trigger::Response& response)
{
  response = publishNext();
  return true;
}
}  // namespace bin_picking_ros
