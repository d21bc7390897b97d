// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include "bin_picking_perception/model/trained_model.hpp"

namespace bin_picking
{
/// Fills what a model knows of its own shape: distance field, symmetry (the stated one, otherwise what the surface
/// shows), near symmetries, and remarks about them. Surface, views and parameters must be there.
/// \param dense the whole surface, from which the model was sampled
void compareWithItself(TrainedModel& model, const PartDefinition& definition, const OrientedPoints& dense);
}  // namespace bin_picking
