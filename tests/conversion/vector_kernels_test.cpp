// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Every kernel on every instruction set of this processor, against the C library's atan2 in a
// wider type.

#include "conversion/vector_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "ada4571.h"
#include "support/seed.h"

namespace ada::test {
namespace {

class OnTarget : public testing::TestWithParam<std::string> {
protected:
  void SetUp() override {
    use_vector_target(GetParam());
    ASSERT_EQ(GetParam(), vector_target());
  }
  void TearDown() override { use_vector_target(""); }
};

INSTANTIATE_TEST_SUITE_P(Every, OnTarget, testing::ValuesIn(vector_targets()),
                         [](const auto &i) { return i.param; });

template <class T> struct Points {
  std::vector<T> y, x, out;
  void add(T yy, T xx) {
    y.push_back(yy);
    x.push_back(xx);
  }
};

/// Angles all around, magnitudes over the whole range of the type, and the edges of the octants.
template <class T> Points<T> many_points(std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> angle(-M_PI, M_PI);
  const double most = std::log10(static_cast<double>(std::numeric_limits<T>::max())) - 1;
  std::uniform_real_distribution<double> exponent(-most, most);
  Points<T> p;
  for (int i = 0; i < 400000; ++i) {
    const double a = angle(rng), m = i % 2 ? 1.0 : std::pow(10.0, exponent(rng));
    p.add(static_cast<T>(m * std::sin(a)), static_cast<T>(m * std::cos(a)));
  }
  for (int octant = 0; octant < 8; ++octant)
    for (int i = -50; i <= 50; ++i) {
      const double a = octant * M_PI / 4 + 4.0 * i * static_cast<double>(std::numeric_limits<T>::epsilon());
      p.add(static_cast<T>(std::sin(a)), static_cast<T>(std::cos(a)));
    }
  p.out.resize(p.y.size());
  return p;
}

template <class T, class Wide> double greatest_error(const Points<T> &p) {
  double worst = 0;
  for (std::size_t i = 0; i < p.y.size(); ++i) {
    const Wide exact = std::atan2(static_cast<Wide>(p.y[i]), static_cast<Wide>(p.x[i]));
    const Wide error = static_cast<Wide>(p.out[i]) - exact;
    if (!(std::abs(error) <= worst)) // catches NaN too
      worst = static_cast<double>(std::abs(error));
    if (std::isnan(error))
      return INFINITY;
  }
  return worst;
}

TEST_P(OnTarget, atan2_f32_stays_within_its_bound) {
  auto p = many_points<float>(fresh_seed());
  atan2_f32(p.y.data(), p.x.data(), p.y.size(), p.out.data());
  const double worst = greatest_error<float, double>(p);
  std::printf("  %s: float %.2e rad\n", vector_target(), worst);
  EXPECT_LT(worst, ADA4571_ATAN2_F32_MAX_ERROR_RAD);
}

TEST_P(OnTarget, atan2_f32_stays_within_its_bound_over_a_dense_octant_sweep) {
  // Every quotient min/max with a step of 2^-20, in all eight octants.
  Points<float> p;
  for (int i = 0; i <= 1 << 20; ++i) {
    const float t = static_cast<float>(i) * 0x1p-20f;
    const float s = i % 2 ? 1.0f : -1.0f, r = i % 3 ? 1.0f : -1.0f;
    i % 5 ? p.add(s * t, r) : p.add(s, r * t);
  }
  p.out.resize(p.y.size());
  atan2_f32(p.y.data(), p.x.data(), p.y.size(), p.out.data());
  EXPECT_LT((greatest_error<float, double>(p)), ADA4571_ATAN2_F32_MAX_ERROR_RAD);
}

TEST_P(OnTarget, atan2_f64_stays_within_its_bound) {
  auto p = many_points<double>(fresh_seed());
  atan2_f64(p.y.data(), p.x.data(), p.y.size(), p.out.data());
  const double worst = greatest_error<double, long double>(p);
  std::printf("  %s: double %.2e rad\n", vector_target(), worst);
  EXPECT_LT(worst, kAtan2F64MaxErrorRad);
}

/// All pairs of C's table of special values, and of numbers around them.
template <class T> void expect_special_values(double bound) {
  const T inf = std::numeric_limits<T>::infinity(), nan = std::numeric_limits<T>::quiet_NaN();
  const T tiny = std::numeric_limits<T>::denorm_min(), huge = std::numeric_limits<T>::max();
  const T values[] = {T(0.0), T(-0.0), T(1), T(-1), inf, -inf, nan, tiny, -tiny, huge, -huge};
  Points<T> p;
  for (const T y : values)
    for (const T x : values)
      p.add(y, x);
  p.out.resize(p.y.size());
  if constexpr (sizeof(T) == 4)
    atan2_f32(p.y.data(), p.x.data(), p.y.size(), p.out.data());
  else
    atan2_f64(p.y.data(), p.x.data(), p.y.size(), p.out.data());
  for (std::size_t i = 0; i < p.y.size(); ++i) {
    const T exact = std::atan2(p.y[i], p.x[i]);
    if (std::isnan(exact)) {
      EXPECT_TRUE(std::isnan(p.out[i])) << p.y[i] << " " << p.x[i];
    } else {
      EXPECT_NEAR(p.out[i], exact, bound) << p.y[i] << " " << p.x[i];
      EXPECT_EQ(std::signbit(p.out[i]), std::signbit(exact)) << p.y[i] << " " << p.x[i];
    }
  }
}

TEST_P(OnTarget, special_values_are_those_of_c) {
  expect_special_values<float>(ADA4571_ATAN2_F32_MAX_ERROR_RAD);
  expect_special_values<double>(kAtan2F64MaxErrorRad);
}

TEST_P(OnTarget, every_count_is_converted_and_nothing_beyond) {
  for (std::size_t n = 0; n <= 70; ++n) {
    std::vector<float> y(n, 1.0f), x(n, 1.0f), out(n + 1, -7.0f);
    atan2_f32(y.data(), x.data(), n, out.data());
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(out[i], M_PI / 4, ADA4571_ATAN2_F32_MAX_ERROR_RAD);
    EXPECT_EQ(out[n], -7.0f);
    std::vector<double> yd(n, 1.0), xd(n, -1.0), outd(n + 1, -7.0);
    atan2_f64(yd.data(), xd.data(), n, outd.data());
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(outd[i], 3 * M_PI / 4, kAtan2F64MaxErrorRad);
    EXPECT_EQ(outd[n], -7.0);
  }
}

TEST(VectorTarget, names_are_known_or_refused) {
  ASSERT_FALSE(vector_targets().empty());
  EXPECT_EQ(vector_targets().front(), vector_target());
  EXPECT_THROW(use_vector_target("ABACUS"), std::invalid_argument);
}

} // namespace
} // namespace ada::test
