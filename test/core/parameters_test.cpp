// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/common/parameters.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "bin_picking_perception/common/error.hpp"

namespace bin_picking
{
namespace
{
enum class Color
{
  Red,
  Green
};

struct Inner
{
  double step = 0.0025;
  double angle = 0.1;
  double curvature = 30;
  bool flag = true;
  void visit(ParameterVisitor& v)
  {
    v.field({"step", "m", "a length", 1e-4, 0.1}, step);
    v.field({"angle", "rad", "an angle", 0, 3.2}, angle);
    v.field({"curvature", "1/m or none", "a curvature"}, curvature);
    v.field({"flag", "", "a switch"}, flag);
  }
};

struct Outer
{
  int count = 5;
  double share = 0.5;
  Color color = Color::Red;
  Inner inner;
  void visit(ParameterVisitor& v)
  {
    v.field({"count", "", "a count", 0, 10}, count);
    v.field({"share", "", "a share", 0, 1}, share);
    v.field({"color", "", "a color"}, color, {{"red", Color::Red}, {"green", Color::Green}});
    v.group("inner", inner);
  }
};

std::string messageOf(const std::function<void()>& call)
{
  try
  {
    call();
  }
  catch (const ParameterError& error)
  {
    return error.what();
  }
  return "";
}

TEST(Parameters, setsNumbersWithAndWithoutUnits)
{
  Outer outer;
  const auto visit = visitor(outer);
  setParameter(visit, "inner.step=3mm");
  EXPECT_DOUBLE_EQ(outer.inner.step, 0.003);
  setParameter(visit, "inner/step", "0.5 cm");
  EXPECT_DOUBLE_EQ(outer.inner.step, 0.005);
  setParameter(visit, "inner/step=2e-3");
  EXPECT_DOUBLE_EQ(outer.inner.step, 0.002);
  setParameter(visit, "inner/angle=12deg");
  EXPECT_NEAR(outer.inner.angle, 0.2094395, 1e-7);
  setParameter(visit, "inner/curvature=0.03/mm");
  EXPECT_DOUBLE_EQ(outer.inner.curvature, 30);
  setParameter(visit, "share=85%");
  EXPECT_DOUBLE_EQ(outer.share, 0.85);
  setParameter(visit, "color=green");
  EXPECT_EQ(outer.color, Color::Green);
  setParameter(visit, "inner/flag=false");
  EXPECT_FALSE(outer.inner.flag);
}

TEST(Parameters, refusesWithASentenceAndLeavesTheValueAlone)
{
  Outer outer;
  const auto visit = visitor(outer);
  EXPECT_NE(messageOf([&] { setParameter(visit, "inner/stepp=3mm"); }).find("did you mean 'inner/step'"),
            std::string::npos);
  EXPECT_NE(messageOf([&] { setParameter(visit, "step=3mm"); }).find("did you mean 'inner/step'"), std::string::npos);
  EXPECT_NE(messageOf([&] { setParameter(visit, "count=11"); }).find("[0, 10]"), std::string::npos);
  EXPECT_NE(messageOf([&] { setParameter(visit, "count=2.5"); }).find("whole number"), std::string::npos);
  EXPECT_NE(messageOf([&] { setParameter(visit, "inner/step=12O"); }), "");
  EXPECT_NE(messageOf([&] { setParameter(visit, "inner/step=3deg"); }).find("mm"), std::string::npos);
  EXPECT_NE(messageOf([&] { setParameter(visit, "inner/step=nan"); }), "");
  EXPECT_NE(messageOf([&] { setParameter(visit, "color=gren"); }).find("did you mean 'green'"), std::string::npos);
  EXPECT_NE(messageOf([&] { setParameter(visit, "inner/flag=maybe"); }).find("true or false"), std::string::npos);
  EXPECT_NE(messageOf([&] { setParameter(visit, "no equals sign"); }), "");
  EXPECT_EQ(outer.count, 5);
  EXPECT_DOUBLE_EQ(outer.inner.step, 0.0025);
}

TEST(Parameters, checksAWholeStruct)
{
  const auto message = [](const std::function<void(Outer&)>& change) {
    Outer outer;
    change(outer);
    const std::string text = messageOf([&] { checkRanges(outer); });
    EXPECT_EQ(areWithinRanges(visitor(outer)), text.empty()) << text;
    return text;
  };
  EXPECT_EQ(message([](Outer&) {}), "");
  EXPECT_EQ(message([](Outer& o) { o.inner.step = 0.1; }), "");
  EXPECT_NE(message([](Outer& o) { o.count = 11; }).find("count"), std::string::npos);
  EXPECT_NE(message([](Outer& o) { o.share = -0.1; }).find("share"), std::string::npos);
  EXPECT_NE(message([](Outer& o) { o.color = static_cast<Color>(7); }).find("color"), std::string::npos);
  EXPECT_NE(message([](Outer& o) { o.inner.step = 1; }).find("inner/step"), std::string::npos);
  for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_NE(message([&](Outer& o) { o.inner.angle = wrong; }).find("inner/angle"), std::string::npos) << wrong;
}

TEST(Parameters, yamlNamesTheLineOfAMistake)
{
  Outer outer;
  const auto visit = visitor(outer);
  setParametersFromYaml(visit, "count: 7\ninner:\n  step: 4mm\n  flag: off\n", "cell.yaml");
  EXPECT_EQ(outer.count, 7);
  EXPECT_DOUBLE_EQ(outer.inner.step, 0.004);
  EXPECT_FALSE(outer.inner.flag);
  const auto unknown = messageOf([&] { setParametersFromYaml(visit, "count: 7\ninner:\n  stip: 4mm\n", "cell.yaml"); });
  EXPECT_NE(unknown.find("cell.yaml:3"), std::string::npos) << unknown;
  EXPECT_NE(messageOf([&] { setParametersFromYaml(visit, "count: [1, 2]\n", "a"); }).find("list"), std::string::npos);
  EXPECT_NE(messageOf([&] { setParametersFromYaml(visit, "{", "a"); }).find("not valid YAML"), std::string::npos);
}

TEST(Parameters, dumpReadsBackTheSame)
{
  Outer outer;
  outer.inner.step = 0.1 / 3;
  outer.color = Color::Green;
  Outer copy;
  setParametersFromYaml(visitor(copy), toYaml(visitor(outer)), "dump");
  EXPECT_EQ(copy.inner.step, outer.inner.step);
  EXPECT_EQ(copy.color, Color::Green);
  EXPECT_EQ(toYaml(visitor(copy)), toYaml(visitor(outer)));
  EXPECT_NE(toMarkdown(visitor(outer)).find("`inner/angle`"), std::string::npos);
}
}  // namespace
}  // namespace bin_picking
