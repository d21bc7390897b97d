// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include <yaml-cpp/yaml.h>

#include "bin_picking_perception/common/error.hpp"
#include "bin_picking_perception/common/parameters.hpp"

namespace bin_picking
{
namespace
{
[[noreturn]] void fail(const std::string& origin, const YAML::Mark& mark, const std::string& what)
{
  throw ParameterError(origin + (mark.is_null() ? "" : ":" + std::to_string(mark.line + 1)) + ": " + what);
}

void setNode(const VisitFunction& visit, const YAML::Node& node, const std::string& path, const std::string& origin)
{
  if (node.IsMap())
  {
    for (const auto& child : node)
      setNode(visit, child.second, path.empty() ? child.first.Scalar() : path + "/" + child.first.Scalar(), origin);
    return;
  }
  if (!node.IsScalar())
    fail(origin, node.Mark(),
         "parameter '" + path + "' must be a single value" +
             (node.IsNull() ? ", but it is empty" : ", but it is a list"));
  try
  {
    setParameter(visit, path, node.Scalar());
  }
  catch (const ParameterError& error)
  {
    fail(origin, node.Mark(), error.what());
  }
}
}  // namespace

void setParametersFromYaml(const VisitFunction& visit, const std::string& yaml, const std::string& origin)
{
  YAML::Node root;
  try
  {
    root = YAML::Load(yaml);
  }
  catch (const YAML::Exception& error)
  {
    fail(origin, error.mark, "not valid YAML: " + error.msg);
  }
  if (root.IsNull())
    return;
  if (!root.IsMap())
    fail(origin, root.Mark(), "expected a map of parameters");
  setNode(visit, root, "", origin);
}
}  // namespace bin_picking
