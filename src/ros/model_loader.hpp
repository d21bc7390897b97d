// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "bin_picking_perception/model/trained_model.hpp"

namespace bin_picking_ros
{
/// Loads, or trains and saves, the models of all parts in a thread of its own: training takes seconds to minutes, and a
/// nodelet's onInit must return at once.
class ModelLoader
{
public:
  enum class State
  {
    Loading,
    Ready,
    Failed
  };
  struct Status
  {
    State state = State::Loading;
    std::string text;  ///< one sentence: what is being done, what is there, or what went wrong
  };
  struct Job
  {
    std::vector<bin_picking::PartDefinition> parts;
    bin_picking::TrainingParameters training;
    std::string cache_directory;
    int num_threads = 0;
  };
  using Models = std::vector<std::shared_ptr<const bin_picking::TrainedModel>>;
  /// Called once, in the loader's thread, when all models are there. An exception makes the state Failed.
  using OnLoaded = std::function<void(const Models&)>;

  ModelLoader(Job job, OnLoaded on_loaded);
  /// Waits for the part in work: training cannot be interrupted.
  ~ModelLoader();
  ModelLoader(const ModelLoader&) = delete;
  ModelLoader& operator=(const ModelLoader&) = delete;

  Status status() const;

private:
  void run(const Job& job, const OnLoaded& on_loaded);
  Models loadAll(const Job& job);
  void report(State state, const std::string& text);

  mutable std::mutex mutex_;
  Status status_;
  bool stop_ = false;
  std::thread thread_;
};
}  // namespace bin_picking_ros
