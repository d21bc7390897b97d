// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
#include "bin_picking_perception/common/figures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace bin_picking
{
namespace
{
TEST(Figures, haveAFixedFormOrAShortOne)
{
  EXPECT_EQ(roundedText(12.345, 1), "12.3");
  EXPECT_EQ(roundedText(2, 3), "2.000");
  EXPECT_EQ(roundedText(0.05, 2), "0.05");
  EXPECT_EQ(roundedText(-0.004, 1), "-0.0");
  EXPECT_EQ(roundedText(9.996, 2), "10.00");
  EXPECT_EQ(roundedText(-1234567.891, 0), "-1234568");
  EXPECT_EQ(roundedText(1e20, 1), "100000000000000000000.0");
  EXPECT_EQ(roundedText(std::numeric_limits<double>::quiet_NaN(), 1), "nan");
  EXPECT_EQ(roundedText(-std::numeric_limits<double>::infinity(), 1), "-inf");
  EXPECT_EQ(metres(0.8172), "0.817 m");
  EXPECT_EQ(millimetres(0.0123), "12.3 mm");
  EXPECT_EQ(degrees(M_PI / 4), "45.0 deg");
  EXPECT_EQ(percent(0.975, 0), "98 %");
  EXPECT_EQ(shortText(0.1, 10), "0.1");
  EXPECT_EQ(shortText(1e-7, 10), "0.0000001");
  EXPECT_EQ(shortText(-1e-12, 10), "0");
  EXPECT_EQ(shortText(-20, 0), "-20");
  EXPECT_EQ(shortText(100, 2), "100");
}

TEST(Figures, aFigureAndItsLimitReadDifferently)
{
  const auto told = [](double figure, double limit) {
    const FigureAndLimit texts = toldApart(figure, limit, millimetres);
    return texts.figure + ", " + texts.limit;
  };
  EXPECT_EQ(told(0.002, 0.003), "2.0 mm, 3.0 mm");
  EXPECT_EQ(told(0.00299, 0.003), "2.99 mm, 3.00 mm");
  EXPECT_EQ(told(0.002999996, 0.003), "2.999996 mm, 3.000000 mm");
  EXPECT_EQ(told(-0.00001, 0), "0.01 mm, 0.00 mm") << "signs are left to the sentence";
  EXPECT_EQ(told(-0.002, -0.001), "2.0 mm, 1.0 mm");
  EXPECT_EQ(told(0.003, 0.003), "3.0 mm, 3.0 mm") << "there is no difference to tell";
  EXPECT_EQ(told(-0.0010000002, 0.001), "1.0 mm, 1.0 mm") << "one is within, the other outside";
  EXPECT_EQ(told(std::numeric_limits<double>::quiet_NaN(), 0.003), "nan mm, 3.0 mm");
  EXPECT_EQ(toldApart(0.8496, 0.85, percent, 0).figure, "84.96 %");
}
}  // namespace
}  // namespace bin_picking
