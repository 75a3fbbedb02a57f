// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Faults of supplies, wires, references and records, as they befall a bench. Their signals are made
// here, and not by the model that is fitted to them.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

double steady(double hz, double t) {
  return kTwoPi * hz * t;
}

bool leaves_over(const Diagnosis &d, const std::string &what) {
  return std::any_of(d.structure.begin(), d.structure.end(), [&](const Structure &s) {
    return s.description.find(what) != std::string::npos;
  });
}

KIND(outputs_without_power_at_an_end_of_the_record_are_told_and_left_out) {
  Bench bench;
  const bool reference = bench.within(0.0, 1.0) < 0.5, at_end = bench.within(0.0, 1.0) < 0.5;
  const double hz = bench.within(3.0, 6.0), tau_s = bench.within(0.5e-3, 5e-3);
  Capture c = bench.capture(6000, 2000.0, 2, [&](double t) { return steady(hz, t); });
  const double at_s = bench.within(0.15, 0.35) * c.time_s.back(),
               rest_v = bench.within(0.0, 1.0) < 0.5 ? 2.5 : 0.02;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double since_s = at_end ? c.time_s[i] - (c.time_s.back() - at_s) : at_s - c.time_s[i];
    if (since_s < 0.0)
      continue;
    const double stays = std::exp(-since_s / tau_s);
    for (auto *v : {&c.vsin_v, &c.vcos_v})
      (*v)[i] = rest_v + ((*v)[i] - rest_v) * stays + bench.normal(0.3 * bench.pair.noise_v);
  }
  if (!reference)
    c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_TRUE(leaves_over(d, "both outputs stand at")) << left_of(d);
  EXPECT_EQ(d.findings.size(), 2u) << left_of(d);
}

KIND(a_shaft_that_stops_has_not_lost_its_power) {
  Bench bench;
  const double hz = bench.within(3.0, 6.0), stop_s = bench.within(1.5, 2.5);
  const Capture c =
      bench.capture(6000, 2000.0, 2, [&](double t) { return steady(hz, std::min(t, stop_s)); });
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  EXPECT_FALSE(leaves_over(d, "both outputs stand at")) << left_of(d);
}

KIND(a_reference_that_is_read_now_and_then_explains_nothing) {
  Bench bench;
  const auto held = static_cast<std::size_t>(bench.within(8.0, 14.0));
  const double hz = bench.within(0.08, 0.15);
  Capture c = bench.capture(340, 16.0, 2, [&](double t) { return steady(hz, t); });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] =
        wrap(steady(hz, c.time_s[i - i % held]) * kDegPerRad + bench.normal(0.01), 360.0);
  const Diagnosis d = diagnose(c, {});
  EXPECT_NE(d.verdict, Verdict::explained) << left_of(d);
  EXPECT_NE(d.verdict, Verdict::no_discrepancy) << left_of(d);
}

KIND(counts_of_a_reference_show_beside_its_delay_on_a_shaft_that_swings) {
  Bench bench;
  bench.pair.noise_v = bench.within(1.2e-3, 1.8e-3) * bench.pair.amplitude_v;
  const double hz = bench.within(1.2, 1.6), step_deg = 360.0 / 2048.0,
               late_s = bench.within(4e-4, 8e-4);
  const auto angle = [&](double t) { return 2.1 * std::sin(kTwoPi * hz * t); };
  Capture c = bench.capture(6500, 1850.0, 4, angle);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] =
        wrap(step_deg * std::round(angle(c.time_s[i] - late_s) * kDegPerRad / step_deg), 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *steps = named(d, "reference-resolution");
  ASSERT_TRUE(steps) << left_of(d);
  EXPECT_NEAR(steps->values[0], step_deg, 1e-5);
  EXPECT_TRUE(named(d, "reference-delay")) << left_of(d);
}

KIND(peaks_are_cut_off_below_spikes) {
  Bench bench;
  const double hz = bench.within(8.0, 14.0),
               level_v = 2.5 + bench.within(0.75, 0.9) * bench.pair.amplitude_v,
               spike_v = bench.within(0.05, 0.1);
  Capture c = bench.capture(4000, 5000.0, 1, [&](double t) { return steady(hz, t); });
  for (std::size_t i = 0; i < c.size(); ++i) {
    for (auto *v : {&c.vsin_v, &c.vcos_v})
      (*v)[i] = std::min((*v)[i], level_v) + bench.normal(1e-3);
    if (bench.within(0.0, 1.0) < 0.03)
      c.vsin_v[i] += bench.within(0.5, 1.5) * spike_v;
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *cut = named(d, "clipping");
  ASSERT_TRUE(cut) << left_of(d);
  EXPECT_NEAR(cut->values[1], level_v, 3e-3);
}

KIND(blocks_of_rows_in_a_wrong_order_are_no_lost_rows) {
  Bench bench;
  const double hz = bench.within(3.0, 6.0);
  Capture c = bench.capture(2400, 400.0, 2, [&](double t) { return steady(hz, t); });
  const auto block = static_cast<std::ptrdiff_t>(bench.within(8.0, 16.0)),
             at = static_cast<std::ptrdiff_t>(bench.within(500.0, 1800.0));
  for (auto *v : {&c.vsin_v, &c.vcos_v, &c.reference_deg})
    std::rotate(v->begin() + at, v->begin() + at + block, v->begin() + at + 2 * block);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  expect_none(d, {"sample-loss"});
  EXPECT_TRUE(leaves_over(d, "out of order")) << left_of(d);
}

KIND(a_shaft_that_hunts_to_and_fro_loses_no_rows) {
  Bench bench;
  const double row_deg = 0.05, far_deg = bench.within(2.0, 4.0);
  const auto each = static_cast<std::size_t>(bench.within(50.0, 90.0));
  const bool reference = bench.within(0.0, 1.0) < 0.5;
  Capture c = bench.capture(4000, 1000.0, 1, [&](double t) {
    const auto row = static_cast<std::size_t>(std::lround(1000.0 * t));
    return kRadPerDeg * (row_deg * static_cast<double>(row) + (row / each % 2 ? far_deg : 0.0));
  });
  if (!reference)
    c.reference_deg.clear();
  expect_none(diagnose(c, {}), {"sample-loss"});
}

KIND(counts_of_many_rows_each_are_in_order) {
  Bench bench;
  bench.pair.noise_v = bench.within(1e-3, 20e-3);
  const double hz = bench.within(0.3, 0.6), step_deg = bench.within(0.3, 1.0);
  Capture c = bench.capture(20000, 10000.0, 1, [&](double t) { return steady(hz, t); });
  for (double &deg : c.reference_deg)
    deg = step_deg * std::floor(deg / step_deg);
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(leaves_over(d, "out of order")) << left_of(d);
  expect_none(d, {"sample-loss"});
}

KIND(rows_that_are_missing_in_a_single_turn_are_told) {
  Bench bench;
  const double hz = 0.15;
  Capture c = bench.capture(15000, 2200.0, 2, [&](double t) { return steady(hz, t); });
  c.reference_deg.clear();
  for (const double at : {0.3, 0.7}) {
    const auto from = static_cast<std::ptrdiff_t>(at * static_cast<double>(c.size()));
    for (auto *v : {&c.vsin_v, &c.vcos_v})
      v->erase(v->begin() + from, v->begin() + from + 350);
  }
  c.time_s.resize(c.vsin_v.size());
  const Diagnosis d = diagnose(c, {});
  EXPECT_TRUE(leaves_over(d, "rows may be missing") || named(d, "sample-loss")) << left_of(d);
}

KIND(a_shaft_at_rest_near_a_peak_has_no_dead_channel) {
  Bench bench;
  const bool of_sin = bench.within(0.0, 1.0) < 0.5;
  const double psi = (of_sin ? 90.0 : 0.0) + bench.within(-2.0, 2.0), noise_deg = 0.06,
               count_v = 5.0 / 4096.0;
  Capture c;
  c.meta.supply_v = 5.0;
  c.meta.periods_per_turn = 1;
  for (std::size_t i = 0; i < 80; ++i) {
    const double at = (psi + bench.normal(noise_deg)) * kRadPerDeg;
    c.time_s.push_back(2e-4 * static_cast<double>(i));
    c.vsin_v.push_back(count_v * std::round((2.5 + 1.4 * std::sin(at)) / count_v));
    c.vcos_v.push_back(count_v * std::round((2.5 + 1.4 * std::cos(at)) / count_v));
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(d.verdict, Verdict::insufficient_data);
  expect_none(d, {"stuck-channel"});
  EXPECT_EQ(d.reason.find("stopped"), std::string::npos) << d.reason;
}

KIND(a_shaft_that_jerks_has_the_noise_that_leads_off_its_figure) {
  Bench bench;
  bench.pair.noise_v = bench.within(2e-3, 8e-3);
  std::vector<double> way{0.0};
  double speed = 0.0;
  for (int i = 0; i < 300; ++i) {
    speed = 0.5 * speed + bench.normal(0.25);
    way.push_back(way.back() + 0.2 + speed);
  }
  Capture c = bench.capture(120, 5.0, 1, [&](double t) {
    return way[static_cast<std::size_t>(std::lround(5.0 * t))];
  });
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  EXPECT_LT(d.noise_rms_v, 1.6 * bench.pair.noise_v) << left_of(d);
  EXPECT_GT(d.noise_rms_v, 0.5 * bench.pair.noise_v) << left_of(d);
}

KIND(what_goes_with_the_angle_is_no_line_over_rows) {
  Bench bench;
  const double hz = 0.2, swing = bench.within(0.6, 0.8), start = bench.within(0.0, kTwoPi);
  const auto angle = [&](double t) {
    return kTwoPi * hz * t + swing * std::sin(0.35 * kTwoPi * hz * t + start);
  };
  Capture c = bench.capture(240, 10.0, 1, angle);
  const double size = bench.within(0.02, 0.03), phase = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double psi = angle(c.time_s[i]) + bench.pair.zero_rad,
                 length = size * bench.pair.amplitude_v * std::cos(3.0 * psi + phase);
    c.vsin_v[i] += length * std::sin(psi);
    c.vcos_v[i] += length * std::cos(psi);
  }
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(leaves_over(d, "a line of")) << left_of(d);
}

KIND(readings_that_wander_stand_in_no_place_whatever_two_wild_rows_are) {
  Bench bench;
  const double fast = bench.within(2.1, 2.4), start = bench.within(0.0, kTwoPi);
  Capture c;
  c.meta.supply_v = 5.0;
  c.meta.periods_per_turn = 1;
  for (std::size_t i = 0; i < 210; ++i) {
    const double t = 0.06 * static_cast<double>(i);
    c.time_s.push_back(0.02 * static_cast<double>(i));
    c.vsin_v.push_back(2.5 + 0.5 * std::sin(t) + 0.2 * std::sin(fast * t + start));
    c.vcos_v.push_back(2.2 + 0.3 * std::cos(fast * t) * std::sin(0.5 * t + start));
  }
  for (const double far_v : {-3.0, 5.5})
    c.vsin_v[static_cast<std::size_t>(bench.within(20.0, 190.0))] += far_v;
  const Diagnosis d = diagnose(c, {});
  EXPECT_EQ(d.reason.find("in one place"), std::string::npos) << d.reason;
}

} // namespace
} // namespace ada::test
