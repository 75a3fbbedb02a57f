// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Structure without a name that some cause of the catalogue follows by chance, because the motion
// of the shaft is not known better.

#include <array>
#include <complex>
#include <functional>
#include <vector>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

using Complex = std::complex<double>;

/// Angle of a shaft whose speed goes from one of these to the next, rpm, with half a cosine; by the
/// time.
std::vector<double> through_speeds(const std::vector<double> &rpm, double duration, double rate) {
  const auto n = static_cast<std::size_t>(duration * rate);
  std::vector<double> out;
  double angle = 0.0;
  for (std::size_t i = 0; i < n; ++i) {
    out.push_back(angle);
    const double at =
        static_cast<double>(i) / static_cast<double>(n) * static_cast<double>(rpm.size() - 1);
    const auto k = static_cast<std::size_t>(at);
    const double part = 0.5 - 0.5 * std::cos(kPi * (at - static_cast<double>(k)));
    angle += (rpm[k] + part * (rpm[k + 1] - rpm[k])) / 60.0 * kTwoPi / rate;
  }
  return out;
}

/// The pair of a bench that draws `z`, VCOS its real part, at these angles of the shaft.
Capture drawn(Bench &bench, double rate, int periods, const std::vector<double> &angle,
              const std::function<Complex(std::size_t)> &z) {
  Capture c = bench.capture(angle.size(), rate, periods, [&](double t) {
    return angle[static_cast<std::size_t>(std::lround(t * rate))];
  });
  const Pair &p = bench.pair;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const Complex v = z(i) * std::polar(1.0, p.zero_rad);
    const double s = std::sin(0.5 * p.delta_rad), k = std::cos(0.5 * p.delta_rad);
    c.vsin_v[i] = 2.5 + bench.normal(p.noise_v) +
                  p.amplitude_v * (1.0 + 0.5 * p.k) * (v.imag() * k + v.real() * s);
    c.vcos_v[i] = 2.5 + bench.normal(p.noise_v) +
                  p.amplitude_v * (1.0 - 0.5 * p.k) * (v.real() * k + v.imag() * s);
  }
  return c;
}

KIND(a_speed_that_changes_within_a_turn_is_no_ripple) {
  Bench bench;
  constexpr std::array kPeriods{4, 7, 11};
  constexpr int kCaptures = 4;
  constexpr double kRate = 5000.0;
  for (int k = 0; k < kCaptures; ++k) {
    const int periods = kPeriods[static_cast<std::size_t>(bench.within(0.0, 2.999))];
    const auto angle = through_speeds({bench.within(40.0, 80.0), bench.within(180.0, 240.0),
                                       bench.within(380.0, 450.0), bench.within(250.0, 330.0)},
                                      bench.within(1.2, 1.9), kRate);
    Capture c = drawn(bench, kRate, periods, angle,
                      [&](std::size_t i) { return std::polar(1.0, periods * angle[i]); });
    c.reference_deg.clear();
    const Diagnosis d = diagnose(c, {});
    expect_pair(d, bench.pair);
    expect_none(d, {"rotation-nonuniformity", "stray-field", "sensor-off-axis"});
  }
}

/// A speed that wanders at random within some two seconds, at two mean speeds.
KIND(a_speed_that_wanders_over_a_turn_is_no_stray_field) {
  Bench bench;
  constexpr double kRate = 100.0;
  const auto n = static_cast<std::size_t>(bench.within(6000.0, 15000.0));
  const double fast = bench.within(0.6, 0.9), slow = bench.within(0.35, 0.5),
               part = bench.within(0.02, 0.06);
  std::vector<double> angle{0.0};
  double once = 0.0, twice = 0.0; // a random course of two poles
  const double keep = std::exp(-1.0 / (kRate * bench.within(0.5, 1.5)));
  for (std::size_t i = 1; i < n; ++i) {
    once = keep * once + bench.normal(1.0);
    twice = keep * twice + (1.0 - keep) * once;
    const double spread = std::sqrt(0.25 / (1.0 - keep)); // of `twice`
    const double mean = 2 * i < n ? fast : slow;
    angle.push_back(angle.back() + kTwoPi * mean / kRate * (1.0 + part * twice / spread));
  }
  Capture c = bench.capture(n, kRate, 1, [&](double t) {
    return angle[std::min(n - 1, static_cast<std::size_t>(std::lround(t * kRate)))];
  });
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"stray-field", "sensor-off-axis", "field-direction-error"});
}

/// What the field is off by is as much at every speed, where a ripple of the shaft is not.
KIND(a_stray_field_at_several_speeds_is_one_without_a_reference) {
  Bench bench;
  constexpr double kRate = 2000.0;
  const double stray = bench.within(0.01, 0.03), direction = bench.within(0.0, kTwoPi);
  const double slow = bench.within(60.0, 90.0);
  const auto angle = through_speeds({slow, slow, 2.0 * slow, 2.0 * slow, 5.0 * slow, 5.0 * slow},
                                    bench.within(20.0, 40.0), kRate);
  const int periods = bench.within(0.0, 1.0) < 0.5 ? 1 : 2;
  Capture c = drawn(bench, kRate, periods, angle, [&](std::size_t i) {
    const Complex field = std::polar(1.0, angle[i]) + std::polar(stray, direction);
    return std::polar(1.0, periods * std::arg(field));
  });
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "stray-field");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], stray, 0.05 * stray) << left_of(d);
}

KIND(a_board_that_tilts_is_never_made_worse) {
  Bench bench;
  const auto n = static_cast<std::size_t>(bench.within(50.0, 130.0));
  const double turns = bench.within(0.9, 1.6), steep = bench.within(0.3, 1.2),
               pitch = bench.within(0.1, 0.5), roll = bench.within(0.1, 0.5),
               start = bench.within(0.0, kTwoPi), often = bench.within(0.5, 2.5);
  std::vector<double> angle;
  for (std::size_t i = 0; i < n; ++i) {
    const double part = static_cast<double>(i) / static_cast<double>(n);
    angle.push_back(kTwoPi * (turns * part + 0.08 * std::sin(5.0 * kTwoPi * part)));
  }
  Capture c = drawn(bench, 10.0, 1, angle, [&](std::size_t i) {
    const double part = static_cast<double>(i) / static_cast<double>(n);
    const double a = pitch * std::sin(often * kTwoPi * part + start),
                 b = roll * std::cos(1.3 * often * kTwoPi * part);
    return std::polar(1.0, angle[i]) + steep * Complex(std::sin(a), std::sin(b));
  });
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  if (d.verdict == Verdict::insufficient_data)
    return;
  EXPECT_GE(d.extended_quality.heldout.log_likelihood,
            d.baseline_quality.heldout.log_likelihood - 1e-6)
      << names(d);
}

/// Where the speed changes so much that the knots of the motion lie close they follow any ripple of
/// order 1: what is fitted beside them is none of the shaft's.
KIND(a_speed_in_ramps_over_a_few_turns_has_no_ripple) {
  Bench bench;
  bench.pair.k = bench.pair.delta_rad = 0.0;
  bench.pair.noise_v = bench.within(2e-3, 6e-3);
  constexpr double kRate = 500.0, kDuration = 12.0;
  const std::vector<double> rpm{bench.within(15.0, 30.0), bench.within(30.0, 60.0),
                                bench.within(20.0, 90.0), bench.within(15.0, 40.0)};
  std::vector<double> angle{0.0};
  for (std::size_t i = 1; i < static_cast<std::size_t>(kRate * kDuration); ++i) {
    const double at = static_cast<double>(i) / (kRate * kDuration) * 3.0;
    const auto k = static_cast<std::size_t>(at);
    const double now = rpm[k] + (at - static_cast<double>(k)) * (rpm[k + 1] - rpm[k]);
    angle.push_back(angle.back() + now / 60.0 * kTwoPi / kRate);
  }
  Capture c = bench.capture(angle.size(), kRate, 1, [&](double t) {
    return angle[static_cast<std::size_t>(std::lround(t * kRate))];
  });
  c.reference_deg.clear();
  expect_none(diagnose(c, {}), {"rotation-nonuniformity", "stray-field", "sensor-off-axis"});
}

/// A coil is switched on over a sector of each pole pair of the motor, and its current comes back
/// by the sensor's ground: both channels are lifted by what the load makes of it. Some cause of the
/// angle follows a small part of that.
KIND(a_ground_that_a_motor_lifts_is_no_cause_of_the_angle) {
  Bench bench;
  constexpr double kRate = 1000.0;
  const auto rows = static_cast<std::size_t>(bench.within(3000.0, 9000.0));
  const double turns = bench.within(5.0, 9.0), span = static_cast<double>(rows) / kRate,
               volts = bench.pair.amplitude_v * bench.within(0.006, 0.03),
               sector = bench.within(0.25, 0.7), from = bench.within(0.0, kTwoPi),
               keeps = std::exp(-1.0 / (kRate * bench.within(0.0005, 0.004)));
  constexpr double pole_pairs = 3.0;
  std::vector<double> angle{0.0};
  for (std::size_t i = 1; i < rows; ++i) {
    const double at = 3.0 * static_cast<double>(i) / static_cast<double>(rows);
    const double speed = at < 1.0 ? 1.0 : at < 2.0 ? 0.4 : -1.0;
    angle.push_back(angle.back() + kTwoPi * 3.0 * turns * speed / static_cast<double>(rows));
  }
  Capture c = bench.capture(rows, kRate, 2, [&](double t) {
    return angle[static_cast<std::size_t>(std::lround(t * kRate))];
  });
  double load[4], phase[4], now = 0.0;
  for (int k = 0; k < 4; ++k) {
    load[k] = bench.normal(0.25);
    phase[k] = bench.within(0.0, kTwoPi);
  }
  for (std::size_t i = 0; i < rows; ++i) {
    double current = 1.0;
    for (int k = 0; k < 4; ++k)
      current += load[k] * std::sin(kTwoPi * (k + 1) * 1.5 * c.time_s[i] / span + phase[k]);
    const bool on = wrap(pole_pairs * angle[i] + from, kTwoPi) < kTwoPi * sector;
    now = keeps * now + (1.0 - keeps) * (on ? current : 0.0);
    c.vsin_v[i] += volts * now;
    c.vcos_v[i] += volts * now;
  }
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"stray-field", "sensor-off-axis", "reference-eccentricity", "offset-step",
                  "cubic-nonlinearity", "weak-field", "channel-skew", "multiplexer-memory",
                  "propagation-delay", "hysteresis"});
}

/// A mount creeps while an arc is swept to and fro once or twice: the zero angle walks at random.
KIND(a_zero_that_creeps_on_an_arc_has_no_cause_in_the_field_or_in_the_motion) {
  Bench bench;
  const double span = bench.within(0.3, 0.7), sweeps = bench.within(2.0, 3.5),
               start = bench.within(0.0, kTwoPi), creeps = bench.within(0.05, 0.2) * kRadPerDeg;
  constexpr double kRows = 2400.0, kRate = 60.0;
  const auto shaft = [&](double t) {
    return start +
           kTwoPi * span * (0.5 - 0.5 * std::cos(0.5 * kTwoPi * sweeps * t * kRate / kRows));
  };
  std::vector<double> walk{0.0};
  for (double k = 1.0; k < kRows; ++k)
    walk.push_back(walk.back() + bench.normal(2.0 * creeps / std::sqrt(kRows)));
  Capture c = bench.capture(static_cast<std::size_t>(kRows), kRate, 2, [&](double t) {
    return shaft(t) + walk[static_cast<std::size_t>(std::lround(t * kRate))];
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"stray-field", "sensor-off-axis", "field-direction-error", "propagation-delay",
                  "hysteresis", "channel-skew", "reference-delay", "reference-eccentricity",
                  "low-pass-rolloff", "cubic-nonlinearity", "quadratic-nonlinearity"});
}

} // namespace
} // namespace ada::test
