// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Benches whose reference plays, jumps, is read too seldom or is driven by a gear; and shapes of
// which nobody can say whose they are.

#include <algorithm>
#include <cmath>

#include "bench.h"
#include "diagnosis/conditions/held_rows.h"

namespace ada::test {
namespace {

/// A shaft that turns at three speeds, one of them backwards, about a second each.
std::function<double(double)> three_speeds(Bench &bench, double seconds) {
  const double a = bench.within(0.7, 1.2), b = -bench.within(1.6, 2.4), c = bench.within(3.0, 4.0);
  const double third = seconds / 3.0;
  return [=](double t) {
    double turns = a * std::min(t, third);
    if (t > third)
      turns += b * std::min(t - third, third);
    if (t > 2.0 * third)
      turns += c * (t - 2.0 * third);
    return kTwoPi * turns;
  };
}

KIND(a_reference_that_is_read_less_often_than_the_pair_is_read_where_it_is_fresh) {
  Bench bench;
  Capture c = bench.capture(12000, 1000.0, 2, three_speeds(bench, 12.0));
  const auto rows = static_cast<std::size_t>(bench.within(5.0, 15.99));
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = c.reference_deg[i - i % rows];
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_TRUE(d.held_reference);
  EXPECT_EQ(d.findings.size(), 2u) << names(d);
  EXPECT_EQ(d.verdict, Verdict::explained);
}

/// A steady spin: the pair keeps even time, and the encoder loses a line between two places of the
/// turn and finds it again at its index.
KIND(an_encoder_that_misses_a_line_is_no_error_of_the_sensor) {
  Bench bench;
  const double hz = bench.within(20.0, 50.0), line_deg = 360.0 / bench.within(500.0, 1500.0),
               lost = bench.within(0.2, 0.8);
  bench.pair.noise_v *= 0.3;
  Capture c = bench.capture(10000, 10000.0, 2, [&](double t) { return kTwoPi * hz * t; });
  for (double &deg : c.reference_deg)
    deg = wrap(deg - (deg / 360.0 > lost ? line_deg : 0.0) + bench.normal(0.004), 360.0);
  const Diagnosis d = diagnose(c, {});
  const std::string what = std::to_string(hz) + " Hz, " + std::to_string(line_deg) + " deg at " +
                           std::to_string(lost) + names(d);
  for (const char *innocent : {"stray-field", "sensor-off-axis", "field-direction-error"})
    EXPECT_FALSE(named(d, innocent)) << what;
  EXPECT_NE(d.verdict, Verdict::explained) << what;
  EXPECT_FALSE(d.extended.remainder) << what;
}

TEST(HeldRows, ACoarseEncoderIsReadInEveryRow) {
  Bench bench;
  for (const bool steady : {true, false}) {
    const double hz = bench.within(0.3, 0.6);
    const auto angle = steady ? wandering(bench, hz, 0.0, 1.0) : three_speeds(bench, 12.0);
    Capture c = bench.capture(12000, 1000.0, 2, angle);
    const double step = 360.0 / std::floor(bench.within(90.0, 720.0));
    for (double &r : c.reference_deg)
      r = step * std::floor(r / step);
    EXPECT_FALSE(fresh_readings(c)) << step;
  }
}

/// A clock that scatters: each reading is taken up to 0.4 periods after its turn.
std::vector<double> uneven_times(Bench &bench, std::size_t n, double rate_hz) {
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i)
    out.push_back((static_cast<double>(i) + bench.within(0.0, 0.4)) / rate_hz);
  return out;
}

KIND(a_coarse_reference_beside_an_uneven_clock_is_no_noise_of_the_angle) {
  Bench bench;
  constexpr std::size_t kRows = 3000;
  constexpr double kRate = 60.0;
  bench.pair.noise_v = bench.within(0.7e-3, 1.2e-3) * bench.pair.amplitude_v;
  const std::vector<double> times = uneven_times(bench, kRows, kRate);
  const auto angle = wandering(bench, bench.within(0.02, 0.08), 0.5, 0.1);
  Capture c = bench.capture(kRows, kRate, 1, [&](double t) {
    return angle(times[static_cast<std::size_t>(std::lround(t * kRate))]);
  });
  c.time_s = times;
  const double step = 360.0 / 2048.0;
  for (double &r : c.reference_deg)
    r = step * std::floor(r / step);
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "reference-resolution");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], step, 0.01 * step);
  EXPECT_FALSE(named(d, "angle-noise")) << names(d);
}

/// A logger that reads fast and slowly by turns, and pauses four times: how the shaft moved in a
/// pause is not known to a degree. One capture in ten had a slip there.
KIND(a_pause_of_the_clock_is_no_slip) {
  constexpr std::size_t kRows = 3000, kBlock = 250;
  for (int capture = 0; capture < 6; ++capture) {
    Bench bench;
    bench.pair.noise_v = 2e-3;
    std::vector<double> times{0.0};
    for (std::size_t i = 1; i < kRows; ++i)
      times.push_back(times.back() +
                      (i / kBlock % 2 == 0 ? 0.025 : 0.004) * bench.within(0.8, 1.2));
    for (int pause = 0; pause < 4; ++pause) {
      const auto from = static_cast<std::size_t>(bench.within(1.0, kRows));
      const double of_s = bench.within(0.5, 3.0);
      for (std::size_t i = from; i < kRows; ++i)
        times[i] += of_s;
    }
    const auto angle =
        wandering(bench, bench.within(0.3, 1.1), 0.05, bench.within(0.5, 4.0) / times.back());
    Capture c = bench.capture(kRows, 1.0, 2, [&](double t) {
      return angle(times[static_cast<std::size_t>(std::lround(t))]);
    });
    c.time_s = times;
    c.reference_deg.clear();
    const Diagnosis d = diagnose(c, {});
    EXPECT_FALSE(named(d, "angle-slip")) << left_of(d);
    EXPECT_FALSE(named(d, "sample-loss")) << left_of(d);
  }
}

KIND(a_reference_that_plays_bends_neither_mismatch_nor_quadrature) {
  Bench bench;
  Capture c = bench.capture(16000, 500.0, 2, [&](double t) {
    const double period = t < 16.0 ? 8.0 : 3.2; // s, there and back
    const double x = t / period - std::floor(t / period);
    return kTwoPi * 0.55 * (1.0 - std::abs(2.0 * x - 1.0));
  });
  const double play = bench.within(0.2, 0.6);
  double at = c.reference_deg.front();
  for (double &r : c.reference_deg) {
    at = std::clamp(at, r - 0.5 * play, r + 0.5 * play);
    r = wrap(at, 360.0);
  }
  expect_pair(diagnose(c, {}), bench.pair);
}

KIND(a_reference_that_loses_its_index_bends_neither_mismatch_nor_quadrature) {
  Bench bench;
  Capture c = bench.capture(14000, 1000.0, 1, three_speeds(bench, 14.0));
  double lost = 0.0;
  std::size_t next = 2000;
  for (std::size_t i = 0; i < c.size(); ++i) {
    if (i == next) {
      lost += bench.within(1.0, 3.0);
      next += static_cast<std::size_t>(bench.within(1500.0, 3000.0));
    }
    c.reference_deg[i] = wrap(c.reference_deg[i] + lost, 360.0);
  }
  expect_pair(diagnose(c, {}), bench.pair, 5e-4);
}

KIND(the_order_of_a_gear_is_known_to_its_error) {
  Bench bench;
  const double hz = bench.within(2.0, 4.0),
               order = std::floor(bench.within(3.0, 9.0)) + bench.within(0.2, 0.8);
  const auto turned = wandering(bench, hz, 0.2, 0.1);
  Capture c = bench.capture(15000, 1000.0, 2, turned);
  const double size = bench.within(0.1, 0.5), phase = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] =
        wrap(c.reference_deg[i] + size * std::sin(order * turned(c.time_s[i]) + phase), 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_EQ(d.findings.size(), 3u) << names(d);
  EXPECT_EQ(d.verdict, Verdict::explained);
  const Finding *gear = named(d, "reference-harmonic");
  ASSERT_TRUE(gear) << names(d);
  ASSERT_GT(gear->std_errors[0], 0.0);
  EXPECT_NEAR(gear->values[0], order, 4.0 * gear->std_errors[0]);
  EXPECT_NEAR(gear->values[1], size, 4.0 * gear->std_errors[1]);
}

KIND(a_line_encoder_that_speeds_up_behind_a_low_pass_holds_to_the_end_of_the_record) {
  Bench bench;
  const int lines = static_cast<int>(bench.within(64.0, 257.0));
  const double seconds = 0.6, from = 100.0 / lines, to = bench.within(2000.0, 3500.0) / lines,
               corner = bench.within(4000.0, 7000.0), slope = (to - from) / seconds;
  // What a filter of first order makes of a sine whose frequency changes slowly against it.
  const auto lag = [&](double t) { return std::atan(lines * (from + slope * t) / corner); };
  Capture c = bench.capture(24000, 40000.0, lines, [&](double t) {
    return kTwoPi * (from * t + 0.5 * slope * t * t) - lag(t) / lines;
  });
  bench.pair.noise_v = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double gain = std::cos(lag(c.time_s[i]));
    c.vsin_v[i] = 2.5 + gain * (c.vsin_v[i] - 2.5);
    c.vcos_v[i] = 2.5 + gain * (c.vcos_v[i] - 2.5);
  }
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *low_pass = named(d, "low-pass-rolloff");
  ASSERT_TRUE(low_pass) << names(d);
  EXPECT_NEAR(low_pass->values[0], corner, 5e-3 * corner);
  EXPECT_EQ(d.verdict, Verdict::explained) << left_of(d);
}

KIND(readings_at_random_times_make_no_wrong_rows_of_the_reference) {
  Bench bench;
  const auto turned = three_speeds(bench, 12.0);
  const double jitter = bench.within(2e-4, 5e-4);
  std::mt19937_64 rng(fresh_seed());
  std::normal_distribution<> late(0.0, jitter);
  const Capture c = bench.capture(12000, 1000.0, 2, [&](double t) { return turned(t); });
  Capture jittered = c;
  for (std::size_t i = 0; i < c.size(); ++i)
    jittered.reference_deg[i] = wrap(turned(c.time_s[i] + late(rng)) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(jittered, {});
  expect_pair(d, bench.pair);
  for (const Structure &s : d.structure)
    EXPECT_EQ(s.description.find("the reference alone is wrong"), std::string::npos)
        << s.description;
}

/// With one period a turn, harmonics that the two channels do not share may be taken for a sensor
/// beside its axis, which then takes a part of the mismatch. The errors must hold the truth either
/// way.
KIND(a_third_harmonic_of_either_channel_is_within_the_errors) {
  Bench bench;
  const auto turned = three_speeds(bench, 12.0);
  Capture c = bench.capture(10000, 833.0, 1, turned);
  const double in_sin = bench.within(0.01, 0.025), in_cos = bench.within(-0.008, 0.008);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double psi = turned(c.time_s[i]) + bench.pair.zero_rad;
    c.vsin_v[i] += in_sin * bench.pair.amplitude_v * std::sin(3.0 * psi);
    c.vcos_v[i] += in_cos * bench.pair.amplitude_v * std::cos(3.0 * psi);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *k = named(d, "amplitude-mismatch"), *delta = named(d, "quadrature-error");
  ASSERT_TRUE(k && delta) << names(d);
  const double second_order = 2e-3 * std::abs(bench.pair.k); // of the two ways to write a gain
  EXPECT_NEAR(k->values[0], bench.pair.k, 3.0 * k->std_errors[0] + second_order);
  EXPECT_NEAR(delta->values[0] * kRadPerDeg, bench.pair.delta_rad,
              3.0 * delta->std_errors[0] * kRadPerDeg + 2e-3 * std::abs(bench.pair.delta_rad));
}

/// Of fewer than six turns only the second order tells the lines of an encoder from a field of the
/// same order: n e^2/2 at twice the order, which an error of the reference has against what it reads
/// and a field has not. Where it drowns in the noise the two are rivals; where it does not, the one
/// that is there is named.
KIND(a_high_order_of_few_turns_is_never_the_wrong_one_of_field_and_reference) {
  Bench bench;
  const double turns = bench.within(2.5, 5.0), e_deg = bench.within(0.03, 0.1);
  const double order = std::round(bench.within(13.5, 50.5));
  const bool in_field = bench.within(0.0, 1.0) < 0.5;
  const auto error = [&](double theta) {
    return e_deg * kRadPerDeg * std::sin(order * theta);
  };
  const auto angle = [&](double t) { return kTwoPi * turns * t / 3.0; };
  Capture c = bench.capture(12000, 4000.0, 2, [&](double t) {
    const double theta = angle(t);
    return in_field ? theta + error(theta) : theta;
  });
  for (size_t i = 0; i < c.size(); ++i) {
    const double theta = angle(static_cast<double>(i) / 4000.0);
    c.reference_deg[i] = wrap((in_field ? theta : theta + error(theta)) * kDegPerRad, 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  constexpr std::string_view kField = "field-direction-error", kReference = "reference-harmonic";
  const Finding *field = named(d, kField), *reference = named(d, kReference);
  ASSERT_NE(field == nullptr, reference == nullptr) << names(d); // one of them
  const Finding &found = field ? *field : *reference;
  EXPECT_DOUBLE_EQ(found.values[0], order);
  EXPECT_NEAR(found.values[1], e_deg, 0.1 * e_deg);
  const bool right = (field != nullptr) == in_field;
  const std::string_view truth = in_field ? kField : kReference;
  EXPECT_TRUE(right ||
              std::count(found.alternatives.begin(), found.alternatives.end(), truth) == 1)
      << (in_field ? "a field: " : "a reference: ") << names(d);
}

/// A tracking loop of second order: right at any speed, and off by the acceleration.
KIND(a_tracking_loop_hides_no_mismatch_and_no_quadrature_error) {
  Bench bench;
  const double rate = 1000.0, w = kTwoPi * bench.within(4.0, 8.0);
  const auto angle = wandering(bench, bench.within(2.0, 4.0), bench.within(0.5, 0.7), 0.7);
  Capture c = bench.capture(16000, rate, 2, angle);
  double at = angle(0.0), speed = (angle(1e-3) - angle(0.0)) * 1e3;
  constexpr int kSteps = 20;
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.reference_deg[i] = wrap(at * kDegPerRad, 360.0);
    for (int k = 0; k < kSteps; ++k) {
      const double dt = 1.0 / (rate * kSteps), t = c.time_s[i] + dt * k, off = angle(t) - at;
      speed += w * w * off * dt;
      at += (speed + 1.4 * w * off) * dt;
    }
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair, 2e-3);
  expect_none(d, {"stray-field", "sensor-off-axis", "low-pass-rolloff", "propagation-delay"});
}

/// The pair's own error is large beside its noise: at its peaks, where the speed changes and across
/// gaps the reference seems to leave the pair, and is right in every row.
KIND(a_reference_that_is_right_is_wrong_in_no_row) {
  Bench bench;
  bench.pair.noise_v = bench.within(1e-5, 5e-5);
  const double late_s = bench.within(3e-5, 2e-4);
  const auto angle = three_speeds(bench, 12.0);
  Capture whole =
      bench.capture(24000, 2000.0, 2, [&](double t) { return angle(std::max(0.0, t - late_s)); });
  Capture c = whole;
  for (auto *column : {&c.time_s, &c.vsin_v, &c.vcos_v, &c.reference_deg})
    column->clear();
  std::size_t gap = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    if (gap == 0 && bench.within(0.0, 1.0) < 2e-4) // the pair loses count in a long one
      gap = static_cast<std::size_t>(bench.within(1.0, 600.0));
    if (gap > 0) {
      --gap;
      continue;
    }
    c.time_s.push_back(whole.time_s[i]);
    c.vsin_v.push_back(whole.vsin_v[i]);
    c.vcos_v.push_back(whole.vcos_v[i]);
    c.reference_deg.push_back(wrap(angle(whole.time_s[i]) * kDegPerRad, 360.0));
  }
  const Diagnosis d = diagnose(c, {});
  for (const Structure &s : d.structure)
    EXPECT_EQ(s.description.find("the reference alone"), std::string::npos) << s.description;
  expect_pair(d, bench.pair);
}

} // namespace
} // namespace ada::test
