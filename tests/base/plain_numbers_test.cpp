// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/plain_numbers.h"

#include <gtest/gtest.h>

namespace {

using ada::in_plain_numbers;

TEST(PlainNumbers, LargeNumbersHaveNoExponent) {
  EXPECT_EQ(in_plain_numbers("1.28e+03 mV rms at 1e+05 Hz, +2.5e+04"),
            "1280 mV rms at 100000 Hz, +25000");
  EXPECT_EQ(in_plain_numbers("(1.234e+03)."), "(1234).");
  EXPECT_EQ(in_plain_numbers("up to 9.99e+14."), "up to 999000000000000.");
}

TEST(PlainNumbers, NothingElseIsTouched) {
  for (const char *text :
       {"", "1.28e-03 mV", "12 mV", "1e+16 V", "1.2345678e+03 s", "1e+300", "run1e+05", "1e+05.csv",
        "/data/1e+05/x", "1.2.3e+04", "e+05", "1e+5", "1e+"})
    EXPECT_EQ(in_plain_numbers(text), text);
}

} // namespace
