// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Every kernel on every instruction set of this processor, against the C library's atan2 in a
// wider type.

#include "conversion/vector_kernels.h"

#include <algorithm>
#include <array>
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

/// What a block of samples goes through, one after the other.
struct Samples {
  std::vector<double> angle, radius;
  std::vector<std::uint32_t> status;
  bool numbers = true;

  /// Angles and radii as given; `volts` gives those of a sample.
  template <class Volts> void finish(const SampleLimits &l, Volts volts) {
    for (std::size_t i = 0; i < angle.size(); ++i) {
      numbers = numbers && std::isfinite(angle[i]) && std::isfinite(radius[i]);
      angle[i] = std::min(angle[i] * l.degrees_per_rad, l.largest_deg);
      const bool within = radius[i] >= l.least_radius && radius[i] <= l.largest_radius;
      status[i] = within ? 0 : ADA4571_SAMPLE_RADIUS;
      for (const double v : volts(i))
        if (v <= l.low_v || v >= l.high_v)
          status[i] |= ADA4571_SAMPLE_RAIL;
    }
  }
};

TEST_P(OnTarget, samples_are_finished_as_one_by_one) {
  std::mt19937_64 rng(fresh_seed());
  std::uniform_int_distribution<int> code(-32768, 32767), few(0, 40);
  std::uniform_real_distribution<> angle(0.0, M_PI), radius(0.5, 1.5);
  const SampleLimits limits{
      180.0 / M_PI, std::nextafter(180.0, 0.0), 0.7, 1.3, 32768.0, 5.0 / 65536.0, 0.05, 4.95};
  SampleLimits of_volts = limits;
  of_volts.offset = 0.0;
  of_volts.scale_v = 1.0;
  for (std::size_t n : {0, 1, 7, 8, 15, 16, 1003}) {
    std::vector<std::int16_t> pairs(2 * n);
    std::vector<double> sin(n), cos(n);
    Samples given{std::vector<double>(n), std::vector<double>(n), std::vector<std::uint32_t>(n)};
    for (std::size_t i = 0; i < n; ++i) {
      for (int k = 0; k < 2; ++k) // rails at both ends, and on the very limit
        pairs[2 * i + k] = static_cast<std::int16_t>(few(rng) == 0   ? -32768 + 16 * few(rng)
                                                     : few(rng) == 0 ? 32767 - 16 * few(rng)
                                                                     : code(rng));
      sin[i] = (pairs[2 * i] + limits.offset) * limits.scale_v;
      cos[i] = (pairs[2 * i + 1] + limits.offset) * limits.scale_v;
      given.angle[i] = few(rng) == 0 ? std::nextafter(M_PI, 4.0) : angle(rng);
      given.radius[i] = few(rng) == 0 ? 0.7 : radius(rng);
    }
    if (n == 1003)
      given.radius[1002] = std::nan("");
    Samples one = given, raw = given, volts = given;
    one.finish(limits, [&](std::size_t i) { return std::array{sin[i], cos[i]}; });
    raw.numbers = finish_pairs_i16(pairs.data(), n, limits, raw.angle.data(), raw.radius.data(),
                                   raw.status.data());
    volts.numbers = finish_planar_f64(sin.data(), cos.data(), n, of_volts, volts.angle.data(),
                                      volts.radius.data(), volts.status.data());
    for (const Samples *other : {&raw, &volts}) {
      EXPECT_EQ(one.angle, other->angle) << n;
      EXPECT_EQ(one.status, other->status) << n;
      EXPECT_EQ(one.numbers, other->numbers) << n;
    }
    std::vector<float> frames(3 * n + 1, -7.0f);
    constexpr float kTurn = 180.0f;
    for (std::size_t i = 0; i < n; i += 5) // a double below the turn, which is the turn as a float
      one.angle[i] = std::nextafter(180.0, 0.0);
    frames_of_floats(one.angle.data(), one.radius.data(), one.status.data(), n, kTurn,
                     frames.data());
    for (std::size_t i = 0; i < n; ++i) {
      const auto deg = static_cast<float>(one.angle[i]);
      EXPECT_EQ(frames[3 * i], deg >= kTurn ? 0.0f : deg);
      if (!std::isnan(one.radius[i])) {
        EXPECT_EQ(frames[3 * i + 1], static_cast<float>(one.radius[i]));
      }
      EXPECT_EQ(frames[3 * i + 2], static_cast<float>(one.status[i]));
    }
    EXPECT_EQ(frames.back(), -7.0f);
  }
}

TEST_P(OnTarget, pairs_of_integers_convert_to_the_same_doubles_as_their_numbers) {
  std::mt19937_64 rng(fresh_seed());
  std::uniform_int_distribution<int> code(0, 65535);
  const PairConstants<double> k{32100.0, 33050.0, 5e-5, 1e-6, 0.25, -2e-6, 5.1e-5, -0.5, M_PI};
  for (std::size_t n : {0, 1, 9, 1001}) {
    std::vector<std::uint16_t> pairs(2 * n);
    std::vector<double> sin(n), cos(n), angle(n + 1, -7.0), radius(n), same(n), same_radius(n);
    for (std::size_t i = 0; i < n; ++i) {
      sin[i] = pairs[2 * i] = static_cast<std::uint16_t>(code(rng));
      cos[i] = pairs[2 * i + 1] = static_cast<std::uint16_t>(code(rng));
    }
    convert_pairs_u16(pairs.data(), n, k, angle.data(), radius.data());
    convert_planar_f64(sin.data(), cos.data(), n, k, same.data(), same_radius.data());
    EXPECT_EQ(angle.back(), -7.0);
    angle.pop_back();
    EXPECT_EQ(angle, same);
    EXPECT_EQ(radius, same_radius);
  }
}

TEST(VectorTarget, names_are_known_or_refused) {
  ASSERT_FALSE(vector_targets().empty());
  EXPECT_EQ(vector_targets().front(), vector_target());
  EXPECT_THROW(use_vector_target("ABACUS"), std::invalid_argument);
}

} // namespace
} // namespace ada::test
