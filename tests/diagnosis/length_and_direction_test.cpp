// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the length of the vector says and what its direction does: beside a length that wanders the
// direction alone tells the pair, and what turns the vector is no matter of its length. The signals
// are made here, and not by the model that is fitted to them.

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

/// A length that wanders: some slow waves, of `rms` together.
std::vector<double> wander(Bench &bench, std::size_t n, double rms) {
  constexpr int kWaves = 6;
  std::vector<double> out(n, 0.0);
  for (int k = 1; k <= kWaves; ++k) {
    const double size = bench.normal(1.0) / k, phase = bench.within(0.0, kTwoPi);
    for (std::size_t i = 0; i < n; ++i)
      out[i] += size * std::sin(0.5 * kTwoPi * k * static_cast<double>(i) / static_cast<double>(n) +
                                phase);
  }
  double sum = 0.0;
  for (double x : out)
    sum += x * x;
  for (double &x : out)
    x *= rms / std::sqrt(sum / static_cast<double>(n));
  return out;
}

/// A joint that waits, and now and then goes to another place: at rest the gain that wanders and
/// the place are one, and a fit to both channels bends the ellipse by them.
KIND(beside_a_gain_that_wanders_the_direction_tells_the_pair) {
  Bench bench;
  constexpr std::size_t kRows = 9000;
  constexpr double kRate = 20.0;
  constexpr std::size_t kMoves = 9;
  std::vector<double> at{0.0}, when;
  for (std::size_t k = 0; k < kMoves; ++k) {
    at.push_back(at.back() + bench.within(0.5, 3.0) * (bench.within(-1.0, 1.0) < 0.0 ? -1.0 : 1.0));
    when.push_back((static_cast<double>(k) + bench.within(0.6, 1.2)) * 44.0);
  }
  const auto place = [&](double t) {
    constexpr double kTakes = 2.5; // s
    double out = at[0];
    for (std::size_t k = 0; k < kMoves; ++k) {
      const double part = std::clamp((t - when[k]) / kTakes, 0.0, 1.0);
      out += (at[k + 1] - at[k]) * part * part * (3.0 - 2.0 * part);
    }
    return out;
  };
  Capture c = bench.capture(kRows, kRate, 1, place);
  const std::vector<double> gain = wander(bench, kRows, bench.within(0.005, 0.02));
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] += gain[i] * (c.vsin_v[i] - 2.5);
    c.vcos_v[i] += gain[i] * (c.vcos_v[i] - 2.5);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *k = named(d, "amplitude-mismatch"), *delta = named(d, "quadrature-error");
  ASSERT_TRUE(k && delta) << left_of(d);
  // A tenth of the smallest that a bench draws; what the wander bends a fit to both by is that
  // whole.
  EXPECT_NEAR(k->values[0], bench.pair.k, 2e-3) << left_of(d);
  EXPECT_NEAR(delta->values[0], bench.pair.delta_rad * kDegPerRad, 0.1) << left_of(d);
  const double noise_deg = bench.pair.noise_v / bench.pair.amplitude_v * kDegPerRad;
  EXPECT_LT(d.extended_quality.heldout.angle_error_rms_deg.value_or(360.0), 1.3 * noise_deg)
      << left_of(d);
}

/// Both channels behind a gain that follows the length of one of them: the length goes with the
/// angle, and the angle is what it was.
void control_gain(Capture &c, double share, double lag_s) {
  double level = 0.0;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double step_s = i == 0 ? 0.0 : c.time_s[i] - c.time_s[i - 1];
    const double now = std::abs(c.vcos_v[i] - kMiddleV);
    level = i == 0 ? now : level + (now - level) * std::min(1.0, step_s / lag_s);
    const double gain = 1.0 - share * level;
    for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
      (*v)[i] = kMiddleV + gain * ((*v)[i] - kMiddleV);
  }
}

/// What a fit to both makes of that as a mismatch, a field error of the second order takes back.
KIND(under_a_gain_control_the_direction_tells_the_pair) {
  Bench bench;
  Capture c = bench.capture(9000, 2000.0, 1, wandering(bench, bench.within(3.0, 5.0), 0.5, 0.4));
  control_gain(c, bench.within(0.1, 0.2), bench.within(0.01, 0.03));
  const Diagnosis d = diagnose(c, {});
  const Finding *k = named(d, "amplitude-mismatch"), *delta = named(d, "quadrature-error");
  ASSERT_TRUE(k && delta) << left_of(d);
  EXPECT_NEAR(k->values[0], bench.pair.k, 2e-3) << left_of(d);
  EXPECT_NEAR(delta->values[0], bench.pair.delta_rad * kDegPerRad, 0.1) << left_of(d);
  expect_none(d, {"sensor-off-axis", "field-direction-error", "stray-field", "reference-harmonic"});
}

/// The length follows quickly, and so with the speed, by more than the angle errs: fitted alike,
/// what it does that no angle repeats gets into the angle, and for its sake nothing would be
/// carried.
KIND(what_repeats_is_carried_beside_a_length_that_does_much_more) {
  Bench bench;
  bench.pair.k = 0.0;
  bench.pair.delta_rad = bench.within(0.12, 0.2) * kRadPerDeg;
  bench.pair.noise_v = 3e-4 * bench.pair.amplitude_v;
  const double a = bench.within(1.5, 2.0), c = bench.within(3.5, 4.5);
  const double e = -bench.within(2.2, 2.8);
  Capture capture = bench.capture(6000, 2000.0, 2, [=](double t) {
    return kTwoPi *
           (a * std::min(t, 1.0) + c * std::clamp(t - 1.0, 0.0, 1.0) + e * std::max(t - 2.0, 0.0));
  });
  control_gain(capture, bench.within(0.06, 0.09), bench.within(3e-3, 4e-3));
  const Diagnosis d = diagnose(capture, {});
  EXPECT_TRUE(d.extended.remainder) << left_of(d);
  const double noise_deg = bench.pair.noise_v / bench.pair.amplitude_v / 2.0 * kDegPerRad;
  EXPECT_LT(d.extended_quality.heldout.angle_error_rms_deg.value_or(360.0), 1.2 * noise_deg)
      << left_of(d);
}

/// An amplifier that bends in the cold: the harmonic comes and goes with the temperature, while the
/// shaft turns so evenly that its order is nearly one frequency. That is no tone.
KIND(a_harmonic_that_grows_over_the_record_is_no_tone) {
  Bench bench;
  constexpr std::size_t kRows = 3000;
  const double turns = bench.within(25.0, 45.0), rate = 1.0;
  const double ripple = bench.within(0.005, 0.02), slow = bench.within(0.0, kTwoPi);
  const auto shaft = [&](double t) {
    const double part = t * rate / static_cast<double>(kRows);
    return kTwoPi * turns * (part + ripple * 0.2 * std::sin(kTwoPi * part + slow));
  };
  Capture c = bench.capture(kRows, rate, 1, shaft);
  const double most = bench.within(0.005, 0.02) * bench.pair.amplitude_v,
               phase = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(kRows);
    const double size = most * (0.2 + 0.8 * part * part), at = 2.0 * shaft(c.time_s[i]) + phase;
    c.vsin_v[i] += size * std::sin(at);
    c.vcos_v[i] += size * std::cos(at);
  }
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"periodic-interference"});
  EXPECT_NE(d.verdict, Verdict::explained) << left_of(d);
}

/// A sensor that resets: its outputs fall to the middle for a while, in a record in which the shaft
/// is turned by hand and nothing but the pair tells how. Rows that no smooth motion fits do not
/// vanish.
KIND(outputs_that_fall_to_the_middle_are_said_without_a_reference) {
  Bench bench;
  constexpr std::size_t kRows = 5000;
  constexpr double kRate = 500.0;
  const double first = bench.within(0.3, 0.6), second = bench.within(1.0, 1.7),
               phase = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(kRows, kRate, 2, [&](double t) {
    return 2.5 * t + 1.3 * std::sin(kTwoPi * first * t) +
           0.6 * std::sin(kTwoPi * second * t + phase);
  });
  const auto from = static_cast<std::size_t>(bench.within(0.3, 0.7) * kRows),
             rows = static_cast<std::size_t>(bench.within(200.0, 350.0));
  for (std::size_t i = from; i < from + rows; ++i) {
    c.vsin_v[i] = 2.5 + bench.normal(bench.pair.noise_v);
    c.vcos_v[i] = 2.5 + bench.normal(bench.pair.noise_v);
  }
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(d.verdict == Verdict::partly_explained || d.verdict == Verdict::unexplained ||
              d.verdict == Verdict::insufficient_data)
      << left_of(d);
}

/// A magnetometer that hardly sees one axis, read in coarse counts: one count turns the thin
/// ellipse by degrees, and no row is out of order.
KIND(counts_on_a_thin_ellipse_are_no_jumps_of_the_angle) {
  Bench bench;
  constexpr double kCount = 1.0 / 64.0;
  bench.pair.amplitude_v = bench.within(0.3, 0.45);
  bench.pair.k = -bench.within(1.25, 1.4);
  bench.pair.noise_v = bench.within(0.02, 0.25) * kCount;
  const double swing = bench.within(0.2, 0.5), phase = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(400, 15.0, 1, [&](double t) {
    return kTwoPi * 2.0 * t / (400.0 / 15.0) + swing * std::sin(0.5 * t + phase);
  });
  for (std::vector<double> *v : {&c.vsin_v, &c.vcos_v})
    for (double &x : *v)
      x = kCount * std::round(x / kCount);
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(left_of(d).find("no shaft turns so"), std::string::npos) << left_of(d);
}

/// Two converters of their own, of which one is read two or three rows late, and a scale that is
/// pulled by hand: the lag grows with the speed, as no quadrature error does.
KIND(a_skew_of_several_rows_is_no_quadrature_error) {
  Bench bench;
  constexpr std::size_t kRows = 800;
  constexpr double kRate = 1000.0;
  bench.pair.delta_rad = 0.0;
  bench.pair.noise_v = 0.005 * bench.pair.amplitude_v;
  const double rows = bench.within(1.8, 2.8), phase = bench.within(0.0, kTwoPi),
               swing = bench.within(0.25, 0.4);
  const auto place = [&](double t) {
    return kTwoPi * (36.0 * t + swing * 36.0 / 8.0 * std::sin(8.0 * t + phase));
  };
  Capture c = bench.capture(kRows, kRate, 1, place);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.vsin_v[i] = 2.5 + bench.normal(bench.pair.noise_v) +
                  bench.pair.amplitude_v * (1.0 + 0.5 * bench.pair.k) *
                      std::sin(place(c.time_s[i] - rows / kRate) + bench.pair.zero_rad);
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "channel-skew");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], rows / kRate, 0.1 * rows / kRate) << left_of(d);
  if (const Finding *delta = named(d, "quadrature-error")) {
    EXPECT_LT(std::abs(delta->values[0]), 0.1 * rows / kRate * 36.0 * 360.0) << left_of(d);
  }
  expect_none(d, {"low-pass-rolloff"});
}

/// A magnet that runs out changes the length several times a turn and turns nothing: of errors of
/// the direction and harmonics that take back each other's turn any length can be made.
KIND(a_length_that_goes_with_the_angle_is_no_sum_of_direction_errors) {
  constexpr int kMagnets = 3;
  constexpr std::size_t kRows = 6000;
  for (int magnet = 0; magnet < kMagnets; ++magnet) {
    Bench bench;
    bench.pair.k = bench.pair.delta_rad = 0.0; // by which nothing could be hidden
    bench.pair.noise_v = bench.within(8e-4, 1.2e-3);
    const double speed = bench.within(2.5, 3.5);
    Capture c = bench.capture(kRows, 670.0, 1, [&](double t) { return kTwoPi * speed * t; });
    std::vector<double> gain(kRows, 1.0);
    for (int order : {3, 5}) {
      const double part = bench.within(0.005, 0.008), phase = bench.within(0.0, kTwoPi);
      for (std::size_t i = 0; i < kRows; ++i)
        gain[i] += part * std::cos(order * c.reference_deg[i] * kRadPerDeg + phase);
    }
    for (std::size_t i = 0; i < kRows; ++i) {
      c.vsin_v[i] = kMiddleV + gain[i] * (c.vsin_v[i] - kMiddleV);
      c.vcos_v[i] = kMiddleV + gain[i] * (c.vcos_v[i] - kMiddleV);
    }
    const Diagnosis d = diagnose(c, {});
    expect_none(d, {"field-direction-error", "reference-harmonic", "sensor-off-axis", "stray-field",
                    "harmonic-distortion"});
  }
}

} // namespace
} // namespace ada::test
