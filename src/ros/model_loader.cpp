// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "model_loader.hpp"

#include <ros/console.h>

#include <boost/filesystem.hpp>
#include <utility>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parallel.hpp"
#include "return_code.hpp"

namespace bin_picking_ros
{
ModelLoader::ModelLoader(Job job, OnLoaded on_loaded)
{
  report(State::Loading, "The models are being loaded.");
  thread_ = std::thread([this, job = std::move(job), on_loaded = std::move(on_loaded)] { run(job, on_loaded); });
}

ModelLoader::~ModelLoader()
{
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stop_ = true;
  }
  thread_.join();
}

ModelLoader::Status ModelLoader::status() const
{
  const std::lock_guard<std::mutex> lock(mutex_);
  return status_;
}

void ModelLoader::report(State state, const std::string& text)
{
  const std::lock_guard<std::mutex> lock(mutex_);
  status_ = {state, text};
}

ModelLoader::Models ModelLoader::loadAll(const Job& job)
{
  boost::system::error_code failure;
  boost::filesystem::create_directories(job.cache_directory, failure);
  if (failure)
    throw bin_picking::FileError("The directory " + job.cache_directory + " for trained models cannot be made: " +
                                 failure.message() + "; set model_cache to one that can be written.");
  const bin_picking::Executor executor(job.num_threads);
  Models models;
  for (const bin_picking::PartDefinition& part : job.parts)
  {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (stop_)
        return {};
      status_.text = "The model of part " + part.name + " (" + std::to_string(models.size() + 1) + " of " +
                     std::to_string(job.parts.size()) + ") is being loaded or trained.";
    }
    std::string note;
    const std::string file = job.cache_directory + "/" + part.name + ".model";
    models.push_back(bin_picking::loadOrTrain(part, job.training, file, executor, note));
    ROS_INFO_STREAM("Part " << part.name << ": model with " << models.back()->points.size() << " points."
                            << (note.empty() ? "" : " ") << note);
  }
  return models;
}

void ModelLoader::run(const Job& job, const OnLoaded& on_loaded)
{
  try
  {
    const Models models = loadAll(job);
    if (models.size() != job.parts.size())  // stopped
      return;
    on_loaded(models);
    report(State::Ready,
           std::to_string(models.size()) + (models.size() == 1 ? " model is" : " models are") + " loaded.");
  }
  catch (...)
  {
    const ReturnCode code = translateException(std::current_exception());
    ROS_ERROR_STREAM("The models could not be loaded. " << code.message);
    report(State::Failed, "The models could not be loaded. " + code.message);
  }
}
}  // namespace bin_picking_ros
