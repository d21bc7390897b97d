// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#pragma once

#include <XmlRpcValue.h>
#include <ros/node_handle.h>

#include <string>
#include <utility>
#include <vector>

namespace bin_picking_ros
{
/// All parameters of a node. \throws bin_picking::ParameterError there are none: parts must be set at least
XmlRpc::XmlRpcValue readTree(const ros::NodeHandle& private_nh);

/// A number, a truth value or a text as text. Whole numbers given as double lose the fraction ("5", not "5.0"), so that
/// both spellings suit both types. \throws bin_picking::ParameterError for lists and binary data
std::string scalarText(XmlRpc::XmlRpcValue& value, const std::string& path);

/// Leaves of a parameter tree as path and text, each by scalarText. \throws as scalarText
std::vector<std::pair<std::string, std::string>> flatten(XmlRpc::XmlRpcValue tree, const std::string& prefix = "");

/// The entries of a text that commas separate, without the white space around them.
std::vector<std::string> splitAtCommas(const std::string& text);

/// A list of texts, or one text by splitAtCommas.
/// \param wanted completes "must name ..." \throws bin_picking::ParameterError anything else
std::vector<std::string> readTexts(XmlRpc::XmlRpcValue& value, const std::string& path, const std::string& wanted);
}  // namespace bin_picking_ros
