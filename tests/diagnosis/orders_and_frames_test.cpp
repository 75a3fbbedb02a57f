// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Causes beside structure at other orders than their own, and errors of a reference that keeps its
// own zero angle in each of several records. The signals are made here, and not by the model that
// is fitted to them.

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "diagnosis/bench.h"
#include "recording/join.h"

namespace ada::test {
namespace {

using Angle = std::function<double(double)>;

/// The capture of a magnet that stands at magnet(shaft(t)), with the shaft's angle as reference.
Capture beside_shaft(Bench &bench, std::size_t rows, double rate_hz, int periods,
                     const Angle &shaft, const Angle &magnet) {
  Capture c = bench.capture(rows, rate_hz, periods, [&](double t) { return magnet(shaft(t)); });
  for (std::size_t i = 0; i < rows; ++i)
    c.reference_deg[i] = wrap(shaft(c.time_s[i]) * kDegPerRad, 360.0);
  return c;
}

/// What both channels make of themselves: `act` of the signal over the amplitude.
void bend(const Bench &bench, Capture &c, const Angle &act) {
  for (auto *column : {&c.vsin_v, &c.vcos_v})
    for (double &v : *column)
      v += bench.pair.amplitude_v * act((v - kMiddleV) / bench.pair.amplitude_v);
}

void expect_near_error(const Finding *f, std::size_t value, double truth, const Diagnosis &d) {
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[value], truth, 5.0 * f->std_errors[value] + 0.03 * std::abs(truth))
      << left_of(d);
}

/// A magnet that runs out comes nearer once a turn: the length of the vector says so, and nothing
/// in the catalogue. It hides neither where the sensor sits nor a bent transfer.
KIND(a_magnet_that_runs_out_hides_no_cause_at_other_orders) {
  Bench bench;
  const double near = bench.within(0.004, 0.005), nearest = bench.within(0.0, kTwoPi),
               beside = bench.within(0.13, 0.18) * kRadPerDeg, way = bench.within(0.0, kTwoPi),
               q3 = bench.within(0.006, 0.008);
  const auto shaft = [](double t) { return kTwoPi * 0.3 * t; };
  Capture c = beside_shaft(bench, 12000, 400.0, 2, shaft,
                           [&](double a) { return a + beside * std::sin(2.0 * a + way); });
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double nearer = 1.0 + near * std::cos(shaft(c.time_s[i]) + nearest);
    for (auto *v : {&c.vsin_v, &c.vcos_v})
      (*v)[i] = kMiddleV + nearer * ((*v)[i] - kMiddleV);
  }
  bend(bench, c, [&](double x) { return q3 * x * x * x; });
  const Diagnosis d = diagnose(c, {});
  expect_near_error(named(d, "sensor-off-axis"), 0, beside * kDegPerRad, d);
  expect_near_error(named(d, "cubic-nonlinearity"), 0, q3, d);
  EXPECT_EQ(d.findings.size(), 4u + (named(d, "angle-noise") != nullptr)) << left_of(d);
}

/// The poles of a ring stand unevenly, which turns the vector all over the turn and leaves its
/// length: a bent transfer is told by that.
KIND(a_ring_with_uneven_poles_hides_no_bent_transfer) {
  Bench bench;
  constexpr int kPoles = 24;
  std::vector<double> off;
  for (int k = 0; k <= kPoles; ++k)
    off.push_back(bench.normal(0.02 * kRadPerDeg));
  off.back() = off.front();
  const auto pitch = [&](double a) {
    const double pole = wrap(a, kTwoPi) / kTwoPi * kPoles;
    const auto k = std::min(static_cast<std::size_t>(pole), static_cast<std::size_t>(kPoles - 1));
    const double part = 0.5 - 0.5 * std::cos(kPi * (pole - static_cast<double>(k)));
    return a + off[k] * (1.0 - part) + off[k + 1] * part;
  };
  const double q2 = std::copysign(bench.within(0.008, 0.02), bench.within(-1.0, 1.0)),
               turns = bench.within(2.4, 4.0);
  const auto shaft = [&](double t) { return kTwoPi * turns / 8.0 * t; };
  Capture c = beside_shaft(bench, 4000, 500.0, kPoles, shaft, pitch);
  bend(bench, c, [&](double x) { return q2 * x * x; });
  const Diagnosis d = diagnose(c, {});
  expect_near_error(named(d, "quadratic-nonlinearity"), 0, q2, d);
  expect_pair(d, bench.pair, 0.002);
}

/// Records of one sensor, before each of which the reference was turned on the shaft: what errs
/// with the reference keeps its place in the reading, what errs with the magnet its place in the
/// turn.
std::vector<std::shared_ptr<const Capture>>
with_turned_reference(Bench &bench, std::size_t records,
                      const std::function<double(double)> &reads) {
  std::vector<std::shared_ptr<const Capture>> out;
  for (std::size_t k = 0; k < records; ++k) {
    const double turned = k == 0 ? 0.0 : bench.within(0.4, 5.9), hz = bench.within(1.0, 2.0);
    Capture c = bench.capture(4000, 200.0, 2, [&](double t) { return kTwoPi * hz * t; });
    for (std::size_t i = 0; i < c.size(); ++i)
      c.reference_deg[i] = wrap(reads(kTwoPi * hz * c.time_s[i] + turned) * kDegPerRad, 360.0);
    out.push_back(std::make_shared<const Capture>(std::move(c)));
  }
  return out;
}

KIND(a_reference_that_was_turned_on_the_shaft_is_told_from_a_stray_field) {
  Bench bench;
  const double e = bench.within(0.05, 0.3) * kRadPerDeg, phase = bench.within(0.0, kTwoPi);
  const Diagnosis d = diagnose(
      *join(with_turned_reference(bench, 2, [&](double a) { return a + e * std::sin(a + phase); })),
      {});
  const Finding *f = named(d, "reference-eccentricity");
  expect_near_error(f, 0, e * kDegPerRad, d);
  if (f) {
    EXPECT_TRUE(f->alternatives.empty()) << left_of(d);
  }
  expect_none(d, {"stray-field", "sensor-off-axis", "field-direction-error"});
}

KIND(a_line_of_the_reference_is_seen_in_several_records) {
  Bench bench;
  const double e = bench.within(0.1, 0.3) * kRadPerDeg, phase = bench.within(0.0, kTwoPi),
               order = std::floor(bench.within(12.0, 36.0));
  const Diagnosis d =
      diagnose(*join(with_turned_reference(
                   bench, 3, [&](double a) { return a + e * std::sin(order * a + phase); })),
               {});
  const Finding *f = named(d, "reference-harmonic");
  expect_near_error(f, 1, e * kDegPerRad, d);
  if (f) {
    EXPECT_NEAR(f->values[0], order, 0.01) << left_of(d);
  }
}

/// Seven degrees between two records are two temperatures where VTEMP says so.
KIND(offsets_that_differ_between_two_temperatures_drift_with_them) {
  Bench bench;
  const double apart_v = bench.within(0.015, 0.028),
               tc = std::copysign(bench.within(0.1, 0.3), bench.within(-1.0, 1.0));
  std::vector<std::shared_ptr<const Capture>> records;
  for (int k = 0; k < 2; ++k) {
    Capture c = bench.capture(3000, 1000.0, 2, [&](double t) { return kTwoPi * 8.0 * t; });
    for (std::size_t i = 0; i < c.size(); ++i) {
      c.vtemp_v.push_back(1.5 + k * apart_v + bench.normal(2e-4));
      c.vsin_v[i] += tc * k * apart_v;
      c.vcos_v[i] -= 0.6 * tc * k * apart_v;
    }
    records.push_back(std::make_shared<const Capture>(std::move(c)));
  }
  const Diagnosis d = diagnose(*join(records), {});
  const Finding *f = named(d, "offset-temperature-drift");
  expect_near_error(f, 0, tc, d);
  expect_none(d, {"offset-step", "offset-wander"});
}

/// From row to row a shaft may turn by more than a radian, and the pair fade nearly out.
KIND(a_pair_that_turns_far_from_row_to_row_does_not_stand_still) {
  Bench bench;
  const double step = bench.within(1.3, 2.4), beat = bench.within(0.01, 0.03);
  Capture c = bench.capture(600, 100.0, 1, [&](double t) { return 100.0 * step * t; });
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double fades = 0.52 + 0.48 * std::cos(kTwoPi * beat * static_cast<double>(i));
    for (auto *v : {&c.vsin_v, &c.vcos_v})
      (*v)[i] = kMiddleV + fades * ((*v)[i] - kMiddleV);
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(d.reason.find("stand"), std::string::npos) << d.reason;
}

/// Where the shaft turns far from row to row differences are the motion's, and what drifts is no
/// noise either.
KIND(what_drifts_while_the_shaft_turns_far_from_row_to_row_is_no_noise) {
  Bench bench;
  const double hz = bench.within(6.0, 11.0), tc = bench.within(0.4, 0.9);
  Capture c = bench.capture(2000, 100.0, 2, [&](double t) { return kTwoPi * hz * t; });
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double warm_v = 0.2 * std::sin(0.2 * c.time_s[i]);
    c.vtemp_v.push_back(1.5 + warm_v);
    for (auto *v : {&c.vsin_v, &c.vcos_v})
      (*v)[i] = kMiddleV + (1.0 - tc * warm_v) * ((*v)[i] - kMiddleV);
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(named(d, "amplitude-temperature-drift")) << left_of(d);
  EXPECT_LT(d.noise_rms_v, 1.3 * bench.pair.noise_v) << left_of(d);
}

/// The same pair, its channels exchanged: what has no name is corrected as well.
KIND(a_pair_the_other_way_round_carries_its_remainder) {
  Bench bench;
  const auto angle = wandering(bench, bench.within(2.0, 4.0), 0.3, 0.3);
  std::vector<std::array<double, 3>> orders; // of the turn, rad, phase
  for (const double order : {3.0, 5.0, 6.0, 7.0, 9.0})
    orders.push_back({order, bench.within(0.3, 0.6) * kRadPerDeg, bench.within(0.0, kTwoPi)});
  const auto errs = [=](double t) {
    const double a = angle(t);
    double out = a;
    for (const auto &[order, size, phase] : orders)
      out += size * std::sin(order * a + phase);
    return out;
  };
  Capture c = bench.capture(12000, 1000.0, 1, errs);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(angle(c.time_s[i]) * kDegPerRad, 360.0);
  Capture other = c;
  std::swap(other.vsin_v, other.vcos_v);
  const Diagnosis as_is = diagnose(c, {}), exchanged = diagnose(other, {});
  const double error = as_is.extended_quality.heldout.angle_error_rms_deg.value_or(1e9);
  EXPECT_LT(error, 0.1) << left_of(as_is);
  EXPECT_LT(exchanged.extended_quality.heldout.angle_error_rms_deg.value_or(1e9), 1.1 * error)
      << left_of(exchanged);
}

} // namespace
} // namespace ada::test
