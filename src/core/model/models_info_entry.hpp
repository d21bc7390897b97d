// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <nlohmann/json.hpp>

#include "bin_picking_perception/model/models_info.hpp"

namespace bin_picking
{
/// One model of a models_info.json. \throws ParameterError what is wrong, without the file and the model
ModelInfo modelInfoFromJson(const nlohmann::json& json);

/// \throws ParameterError a diameter or box that modelInfoFromJson would refuse
nlohmann::json toJson(const ModelInfo& info);
}  // namespace bin_picking
