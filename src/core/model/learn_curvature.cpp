// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "learn_curvature.hpp"

#include <algorithm>
#include <cmath>

#include "bin_picking_perception/common/figures.hpp"
#include "bin_picking_perception/scene/surface_resampling.hpp"
#include "view_curvature.hpp"

namespace bin_picking
{
namespace
{
std::vector<float> allRound(const TrainedModel& model, const OrientedPoints& points, const OrientedPoints& dense,
                            const Executor& executor)
{
  const TrainingParameters& p = model.parameters;
  return allRoundCurvature(points, dense, p.curvature_measure, p.curvature_radius, executor);
}

/// \return the repeatability
double takeFromViews(TrainedModel& model, const OrientedPoints& dense, const std::vector<PartView>& views,
                     const Executor& executor)
{
  ViewCurvature seen = curvatureInViews(views, model.points.size());
  std::vector<int> unseen;
  for (std::size_t i = 0; i < seen.mean.size(); ++i)
    if (std::isnan(seen.mean[i]))
      unseen.push_back(static_cast<int>(i));
  const std::vector<float> rest = allRound(model, select(model.points, unseen), dense, executor);
  for (std::size_t k = 0; k < unseen.size(); ++k)
    seen.mean[static_cast<std::size_t>(unseen[k])] = rest[k];
  model.points.curvature = std::move(seen.mean);
  return seen.repeatability;
}

/// The feature of a part whose curvature has so many bins, and why.
void settleFeature(TrainedModel& model, double range, double repeatability, int bins)
{
  const std::string unit = model.parameters.curvature_measure == CurvatureMeasure::MeanCurvature ? " 1/m" : "";
  const std::string known = repeatability > 0 ? "single views repeat it to " + roundedText(repeatability, 1) + unit
                                              : "how well single views repeat it is not known";
  const bool pays =
      bins >= MIN_AUTOMATIC_CURVATURE_BINS && range >= MIN_CURVATURE_RANGE * curvatureScale(model.parameters);
  model.parameters.feature = pays ? FeatureKind::CurPpf : FeatureKind::Ppf;
  model.remarks.push_back(std::string(pays ? "feature cur_ppf" : "feature ppf, without curvature") +
                          ": the curvature ranges over " + roundedText(range, 1) + unit + ", " + known + ", " +
                          (bins == 1 ? "so that it is all one" : "enough for " + std::to_string(bins) + " bins"));
}
}  // namespace

double curvatureScale(const TrainingParameters& parameters)
{
  return parameters.curvature_measure == CurvatureMeasure::MeanCurvature ? 1 / parameters.curvature_radius : 1.0;
}

int learnCurvature(TrainedModel& model, const OrientedPoints& dense, const std::vector<PartView>& views,
                   const Executor& executor)
{
  double repeatability = 0;
  if (model.parameters.curvature_in_views && !views.empty())
    repeatability = takeFromViews(model, dense, views, executor);
  else
    model.points.curvature = allRound(model, model.points, dense, executor);
  const double range = curvatureRange(model.points.curvature);
  const int bins = distinguishableBins(range, repeatability);
  if (model.parameters.feature == FeatureKind::Auto)
    settleFeature(model, range, repeatability, bins);
  return std::max(bins, MIN_AUTOMATIC_CURVATURE_BINS);
}
}  // namespace bin_picking
