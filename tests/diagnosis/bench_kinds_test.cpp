// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Captures of benches that the catalogue does not describe. Their signals are made here, and not by
// the model that is fitted to them.

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "diagnosis/diagnose.h"
#include "recording/join.h"
#include "support/seed.h"

namespace ada::test {
namespace {

/// What the tests look for: mismatch and quadrature that every pair has.
struct Pair {
  double amplitude_v, k, delta_rad, zero_rad, noise_v;
};

class Bench {
public:
  Bench() : rng_(fresh_seed()) {
    const auto either = [&](double low, double high) {
      return within(low, high) * (within(-1.0, 1.0) < 0.0 ? -1.0 : 1.0);
    };
    pair = {within(0.6, 1.5), either(0.02, 0.1), either(1.0, 5.0) * kRadPerDeg, within(0.0, kTwoPi),
            within(3e-4, 1e-3)};
  }
  double within(double low, double high) {
    return std::uniform_real_distribution<>(low, high)(rng_);
  }

  /// `n` samples at `rate_hz` of a shaft at angle(t), mechanical rad, with `periods` a turn.
  Capture capture(std::size_t n, double rate_hz, int periods,
                  const std::function<double(double)> &angle) {
    std::normal_distribution<> noise(0.0, pair.noise_v);
    Capture c;
    c.meta.supply_v = 5.0;
    c.meta.periods_per_turn = periods;
    for (std::size_t i = 0; i < n; ++i) {
      const double t = static_cast<double>(i) / rate_hz, psi = periods * angle(t) + pair.zero_rad;
      c.time_s.push_back(t);
      c.vsin_v.push_back(2.5 + noise(rng_) +
                         pair.amplitude_v * (1.0 + 0.5 * pair.k) *
                             std::sin(psi + 0.5 * pair.delta_rad));
      c.vcos_v.push_back(2.5 + noise(rng_) +
                         pair.amplitude_v * (1.0 - 0.5 * pair.k) *
                             std::cos(psi - 0.5 * pair.delta_rad));
      c.reference_deg.push_back(wrap(angle(t) * kDegPerRad, 360.0));
    }
    return c;
  }

  Pair pair;

private:
  std::mt19937_64 rng_;
};

const Finding *named(const Diagnosis &d, std::string_view id) {
  const auto f = std::find_if(d.findings.begin(), d.findings.end(),
                              [&](const Finding &x) { return x.effect->info().id == id; });
  return f == d.findings.end() ? nullptr : &*f;
}

std::string names(const Diagnosis &d) {
  std::string out;
  for (const Finding &f : d.findings) {
    out += std::string(f.effect->info().id);
    for (double v : f.values)
      out += " " + std::to_string(v);
    out += "; ";
  }
  return out;
}

/// Mismatch and quadrature with their values, within a hundredth of the larger of them, or within
/// `close_rad` of what else there is.
void expect_pair(const Diagnosis &d, const Pair &pair, double close_rad = 0.0) {
  const Finding *k = named(d, "amplitude-mismatch"), *delta = named(d, "quadrature-error");
  ASSERT_TRUE(k && delta) << names(d);
  const double close =
      std::max(close_rad, 0.01 * std::max(std::abs(pair.k), std::abs(pair.delta_rad)));
  EXPECT_NEAR(k->values[0], pair.k, close);
  EXPECT_NEAR(delta->values[0] * kRadPerDeg, pair.delta_rad, close);
}

TEST(BenchKinds, wrong_rows_of_the_reference_spoil_nothing) {
  Bench bench;
  const double rpm = bench.within(60.0, 200.0);
  Capture c = bench.capture(12000, 3000.0, 2, [&](double t) { return t * rpm / 60.0 * kTwoPi; });
  std::size_t wrong = 0;
  for (std::size_t i = 50; i + 50 < c.size();
       i += static_cast<std::size_t>(bench.within(100, 300))) {
    // Of the counter: 180 deg to 11 deg, several times what a strongly elliptic pair does by
    // itself.
    const double bit = std::floor(bench.within(1.0, 6.0));
    c.reference_deg[i] = wrap(c.reference_deg[i] + 360.0 / std::exp2(bit), 360.0);
    ++wrong;
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_EQ(d.findings.size(), 2u);
  ASSERT_FALSE(d.structure.empty());
  const std::string &said = d.structure.front().description,
                    begin = "the reference alone is wrong in ";
  ASSERT_NE(said.find(begin), std::string::npos) << said;
  // A row may fall to either side beside the steepest stretch of a strongly elliptic pair.
  EXPECT_NEAR(std::stod(said.substr(said.find(begin) + begin.size())), static_cast<double>(wrong),
              2.0)
      << said;
}

TEST(BenchKinds, a_reference_that_jumps_at_a_steady_spin_is_the_one_to_blame) {
  Bench bench;
  Capture c = bench.capture(20000, 4000.0, 1, [](double t) { return 2.1 * kTwoPi * t; });
  const double step_deg = bench.within(0.15, 0.3), from = bench.within(60.0, 300.0);
  for (double &r : c.reference_deg)
    if (r > from)
      r -= step_deg;
  const Diagnosis d = diagnose(c, {});
  // Its second order, of no more than this amplitude, turns the vector as a mismatch does.
  expect_pair(d, bench.pair, step_deg * kRadPerDeg / (0.5 * kTwoPi));
  for (const char *innocent : {"stray-field", "sensor-off-axis", "field-direction-error"})
    EXPECT_FALSE(named(d, innocent)) << names(d);
}

TEST(BenchKinds, lash_is_seen_where_the_shaft_turns_back_for_less_than_a_turn) {
  Bench bench;
  const double width_deg = bench.within(0.1, 0.3);
  const auto angle = [](double t) { return 6.0 * std::sin(0.69 * t) + 1.9 * t; };
  Capture c = bench.capture(24000, 2000.0, 2, angle);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double speed = 6.0 * 0.69 * std::cos(0.69 * c.time_s[i]) + 1.9;
    c.reference_deg[i] =
        wrap(c.reference_deg[i] + 0.5 * width_deg * std::tanh(speed / 0.02), 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "hysteresis");
  ASSERT_TRUE(f);
  EXPECT_NEAR(f->values[0], width_deg, 0.02 * width_deg);
}

TEST(BenchKinds, a_shaft_that_is_slow_now_and_then_does_not_stop) {
  Bench bench;
  const double late_s = bench.within(2e-4, 8e-4);
  const auto angle = [&](double t) { // from standstill to 2.5 turns a second and back
    return kTwoPi * (1.2 * t - 0.62 * std::sin(1.9 * t));
  };
  Capture c = bench.capture(25000, 5000.0, 1, [&](double t) { return angle(t - late_s); });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(angle(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "propagation-delay");
  ASSERT_TRUE(f);
  EXPECT_NEAR(f->values[0], late_s, 0.02 * late_s);
}

TEST(BenchKinds, fringes_there_and_back_are_no_tone) {
  Bench bench;
  // A mirror on a triangle of 60 fringes: the fringes are weaker the farther it is.
  const double far = 60.0 * kTwoPi, ramp_s = 1.0 / 3.0, less = bench.within(0.02, 0.06);
  const double start = bench.within(0.0, 1.0);
  const auto place = [&](double t) {
    const double u = std::fmod(t / ramp_s + start, 2.0);
    return far * std::abs(u - 1.0);
  };
  Capture c = bench.capture(40000, 20000.0, 1, place);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double x = place(c.time_s[i]) / far, seen = 1.0 - less * x * x;
    c.vsin_v[i] = 2.5 + (c.vsin_v[i] - 2.5) * seen;
    c.vcos_v[i] = 2.5 + (c.vcos_v[i] - 2.5) * seen;
  }
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_FALSE(named(d, "periodic-interference"));
}

TEST(BenchKinds, a_magnet_of_many_orders_hides_neither_mismatch_nor_quadrature) {
  Bench bench;
  const double rpm = bench.within(60.0, 300.0);
  std::vector<std::array<double, 2>> flaws; // size and phase, rad
  for (int order = 1; order <= 9; ++order)
    flaws.push_back({bench.within(0.5, 1.0) / order * kRadPerDeg, bench.within(0.0, kTwoPi)});
  const auto shaft = [&](double t) { return t * rpm / 60.0 * kTwoPi; };
  Capture c = bench.capture(30000, 1500.0, 2, [&](double t) {
    double angle = shaft(t);
    for (std::size_t k = 0; k < flaws.size(); ++k)
      angle += flaws[k][0] * std::sin(static_cast<double>(k + 1) * shaft(t) + flaws[k][1]);
    return angle;
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  // A flaw turns the vector and leaves its length, all but a thousandth: what two of them of a
  // degree make together.
  expect_pair(diagnose(c, {}), bench.pair, 1e-3);
}

TEST(BenchKinds, a_tone_near_the_frequency_of_the_pair_is_one_tone_without_a_reference) {
  Bench bench;
  const double turns_hz = bench.within(30.0, 45.0);
  Capture c = bench.capture(40000, 4000.0, 1, [&](double t) { return kTwoPi * turns_hz * t; });
  c.reference_deg.clear();
  const double off = bench.within(8.0, 16.0), tone_hz = turns_hz + off;
  const double sin_v = bench.within(0.003, 0.006), cos_v = bench.within(0.003, 0.006);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double phase = kTwoPi * tone_hz * c.time_s[i];
    c.vsin_v[i] += sin_v * std::sin(phase);
    c.vcos_v[i] += cos_v * std::sin(phase + 0.3);
  }
  const Diagnosis d = diagnose(c, {});
  std::size_t tones = 0;
  for (const Finding &f : d.findings)
    if (f.effect->info().id == "periodic-interference") {
      ++tones;
      EXPECT_NEAR(f.values[0], tone_hz, 0.01);
      EXPECT_NEAR(f.values[1], sin_v, 0.03 * sin_v) << names(d);
      EXPECT_NEAR(f.values[2], cos_v, 0.03 * cos_v) << names(d);
    }
  EXPECT_EQ(tones, 1u) << names(d);
}

TEST(BenchKinds, where_a_second_capture_begins_the_magnet_has_not_slipped) {
  Bench bench;
  const double stray = bench.within(0.01, 0.04), direction = bench.within(0.0, kTwoPi);
  std::vector<std::shared_ptr<const Capture>> captures;
  for (int k = 0; k < 2; ++k) {
    // Some turns and a part of one, which bends a zero angle that knows nothing of the stray field.
    const double from = bench.within(0.0, kTwoPi), mounted_deg = bench.within(0.0, 360.0);
    const double hz = bench.within(6.3, 6.8) / 5.0;
    const auto shaft = [&](double t) { return from + kTwoPi * hz * t; };
    Capture c = bench.capture(10000, 2000.0, 2, [&](double t) {
      const double field = shaft(t);
      return field + std::atan2(stray * std::sin(direction - field),
                                1.0 + stray * std::cos(direction - field));
    });
    for (std::size_t i = 0; i < c.size(); ++i)
      c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad + mounted_deg, 360.0);
    captures.push_back(std::make_shared<Capture>(std::move(c)));
  }
  const Diagnosis d = diagnose(*join(captures), {});
  EXPECT_FALSE(named(d, "angle-slip")) << names(d);
}

} // namespace
} // namespace ada::test
