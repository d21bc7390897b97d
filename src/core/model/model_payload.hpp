// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "bin_picking_perception/model/trained_model.hpp"

namespace bin_picking
{
/// Every field of the model, one after the other. Any change here needs another MODEL_FILE_VERSION.
std::vector<char> writePayload(const TrainedModel& model);

/// \throws std::runtime_error sizes that exceed the data, or parts that do not fit together: the text says which
std::shared_ptr<const TrainedModel> readPayload(const char* begin, std::size_t size);
}  // namespace bin_picking
