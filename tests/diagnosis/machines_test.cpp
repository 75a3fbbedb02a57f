// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Machines that lose rows, make quick moves, or are held against an encoder that counts coarsely.
// Their signals are made here, and not by the model that is fitted to them.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string_view>
#include <vector>

#include "diagnosis/bench.h"

namespace ada::test {
namespace {

/// Without these rows, as if they had never been: the clock of the record runs on unbroken.
void lose(Capture &c, std::size_t first, std::size_t count) {
  for (auto *column : {&c.vsin_v, &c.vcos_v, &c.vtemp_v, &c.vdd_v, &c.reference_deg})
    if (!column->empty())
      column->erase(column->begin() + static_cast<std::ptrdiff_t>(first),
                    column->begin() + static_cast<std::ptrdiff_t>(first + count));
  c.time_s.resize(c.time_s.size() - count);
}

/// A reference on the motor, the pair on a load behind rubber: it lags by friction, by drag and by
/// inertia. A supply would move the length of the vector as well.
KIND(a_coupling_that_twists_is_no_supply) {
  Bench bench;
  constexpr double kRate = 100.0;
  const double swing_hz = bench.within(0.02, 0.05), wide = kTwoPi * bench.within(0.7, 2.0),
               more = bench.within(0.1, 0.3);
  const double w = kTwoPi * swing_hz, inertia_s2 = bench.within(2e-3, 1e-2),
               drag_s = bench.within(0.0, 3e-3), play = bench.within(0.05, 0.4) * kRadPerDeg;
  const auto motor = [&](double t) {
    return wide * (std::sin(w * t) + more * std::sin(3.3 * w * t));
  };
  const auto speed = [&](double t) {
    return wide * w * (std::cos(w * t) + 3.3 * more * std::cos(3.3 * w * t));
  };
  const auto acceleration = [&](double t) {
    return -wide * w * w * (std::sin(w * t) + 3.3 * 3.3 * more * std::sin(3.3 * w * t));
  };
  const auto n = static_cast<std::size_t>(bench.within(8000.0, 16000.0));
  Capture c = bench.capture(n, kRate, 2, [&](double t) {
    return motor(t) - 0.5 * play * std::tanh(speed(t) / 0.01) - drag_s * speed(t) -
           inertia_s2 * acceleration(t);
  });
  for (std::size_t i = 0; i < n; ++i)
    c.reference_deg[i] = wrap(motor(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"supply-variation", "gain-wander", "amplitude-noise"});
}

/// A spindle whose belt makes it ripple once a turn, and a logger that drops packets without a
/// word: the ripple hides that whole numbers of rows are missing, and behind each gap it goes on
/// where the shaft is.
KIND(a_ripple_goes_on_behind_rows_that_are_lost) {
  Bench bench;
  const double hz = bench.within(100.0, 180.0), ripple = bench.within(0.3, 1.2) * kRadPerDeg,
               phase = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(20000, 50000.0, 1, [=](double t) {
    const double even = kTwoPi * hz * t;
    return even + ripple * std::sin(even + phase);
  });
  c.reference_deg.clear();
  std::size_t lost = 0;
  constexpr std::size_t kEvents = 3;
  for (std::size_t k = 0; k < kEvents; ++k) {
    const auto rows = static_cast<std::size_t>(bench.within(16.0, 64.0));
    lose(c, static_cast<std::size_t>(bench.within(4000.0, 6000.0)) * (kEvents - k) - 2000, rows);
    lost += rows;
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *loss = named(d, "sample-loss"), *turns = named(d, "rotation-nonuniformity");
  ASSERT_TRUE(loss && turns) << names(d);
  EXPECT_EQ(loss->values[0], static_cast<double>(kEvents));
  EXPECT_NEAR(loss->values[1], static_cast<double>(lost), 2.0);
  EXPECT_EQ(turns->values[0], 1.0);
  EXPECT_NEAR(turns->values[1] * kRadPerDeg, ripple, 0.03 * ripple);
  expect_none(d, {"angle-slip"});
}

/// From one place to the next in a few rows, and at rest between.
std::function<double(double)> moves(Bench &bench, double dwell_s, double move_s) {
  std::vector<double> places(400);
  for (double &x : places)
    x = bench.within(0.0, 3.0 * kTwoPi);
  return [=](double t) {
    const double whole = std::floor(t / dwell_s), into = (t - whole * dwell_s) / move_s;
    const auto k = static_cast<std::size_t>(whole) % (places.size() - 1);
    const double part = std::clamp(into, 0.0, 1.0);
    return places[k] + (places[k + 1] - places[k]) * part * part * (3.0 - 2.0 * part);
  };
}

KIND(a_quick_move_between_rests_is_no_spike) {
  Bench bench;
  Capture c = bench.capture(8000, 200.0, 2, moves(bench, bench.within(0.4, 0.8), 0.05));
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  expect_none(d, {"impulse-noise", "sample-loss", "angle-slip"});
}

/// A logger that reads when it comes to it, with the right time beside each row.
KIND(a_shaft_that_turns_fast_under_an_uneven_clock_makes_no_spike) {
  Bench bench;
  const auto angle = wandering(bench, bench.within(1.5, 3.0), 0.6, bench.within(0.1, 0.3));
  std::vector<double> times;
  for (double t = 0.0; times.size() < 6000;) {
    t += 0.01 * bench.within(0.4, bench.within(0.0, 1.0) < 0.05 ? 4.0 : 1.6);
    times.push_back(t);
  }
  Capture c = bench.capture(times.size(), 1.0, 1, [&](double row) {
    return angle(times[static_cast<std::size_t>(std::lround(row))]);
  });
  c.time_s = times;
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  expect_none(d, {"impulse-noise"});
}

/// A ring of many poles against an encoder whose step is a good part of a period: a tenth of a
/// volt of rounding lies along the figure, and a skew of microvolts shows beside it.
KIND(beside_a_coarse_encoder_a_ring_shows_its_skew_and_its_low_pass) {
  Bench bench;
  bench.pair.noise_v = bench.within(1e-3, 2.5e-3);
  constexpr double kRate = 5000.0;
  constexpr int kPoles = 48, kCounts = 1440;
  const double top_hz = bench.within(4.0, 6.0), skew_s = bench.within(1e-5, 2.5e-5),
               corner_hz = bench.within(900.0, 1600.0);
  const auto angle = [=](double t) { // up and down again in three seconds
    return kTwoPi * top_hz * (0.5 * t - 1.5 / kTwoPi * std::sin(kTwoPi * t / 3.0) * 0.9);
  };
  const auto hz = [=](double t) {
    return kPoles * top_hz * (0.5 - 0.45 * std::cos(kTwoPi * t / 3.0));
  };
  Capture c = bench.capture(15000, kRate, kPoles, angle);
  const Pair &p = bench.pair;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double t = c.time_s[i], x = hz(t) / corner_hz, gain = 1.0 / std::sqrt(1.0 + x * x);
    const double psi = kPoles * angle(t) + p.zero_rad - std::atan(x);
    c.vsin_v[i] = 2.5 + bench.normal(p.noise_v) +
                  p.amplitude_v * gain * (1.0 + 0.5 * p.k) * std::sin(psi + 0.5 * p.delta_rad);
    c.vcos_v[i] = 2.5 + bench.normal(p.noise_v) +
                  p.amplitude_v * gain * (1.0 - 0.5 * p.k) *
                      std::cos(psi - 0.5 * p.delta_rad + kTwoPi * hz(t) * skew_s);
    c.reference_deg[i] = 360.0 / kCounts * std::floor(wrap(angle(t), kTwoPi) / kTwoPi * kCounts);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, p, 0.003);
  const Finding *skew = named(d, "channel-skew"), *low = named(d, "low-pass-rolloff");
  ASSERT_TRUE(skew && low && named(d, "reference-resolution")) << names(d);
  EXPECT_NEAR(skew->values[0], skew_s, 0.2 * skew_s);
  EXPECT_NEAR(low->values[0], corner_hz, 0.1 * corner_hz);
  EXPECT_NEAR(d.noise.along_v, p.noise_v, 0.15 * p.noise_v);
  expect_none(d, {"excess-noise", "propagation-delay", "reference-harmonic", "angle-noise"});
}

/// There and back in steps, with a gear between table and encoder.
KIND(a_play_of_the_encoders_gear_is_no_slip) {
  Bench bench;
  const double play = bench.within(0.1, 0.4) * kRadPerDeg;
  const auto angle = [](double t) {
    const double whole = std::floor(t / 0.6), part = std::clamp((t / 0.6 - whole) * 1.5, 0.0, 1.0);
    const double there = kTwoPi / 12.0 * (whole + part * part * (3.0 - 2.0 * part));
    return std::min(there, kTwoPi / 12.0 * 40.0 - there);
  };
  Capture c = bench.capture(12000, 500.0, 2, angle);
  double follows = -play;
  for (std::size_t i = 0; i < c.size(); ++i) {
    follows = std::clamp(follows, angle(c.time_s[i]) - play, angle(c.time_s[i]) + play);
    c.reference_deg[i] = wrap(follows * kDegPerRad, 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  expect_none(d, {"angle-slip", "hysteresis"});
  EXPECT_NE(d.verdict, Verdict::explained);
}

/// The same table and a magnet that slips on the way: that is one.
KIND(a_slip_on_the_way_there_is_a_slip) {
  Bench bench;
  const double slip = bench.within(0.2, 0.8) * kRadPerDeg;
  const auto at = static_cast<std::size_t>(bench.within(2000.0, 5000.0));
  const auto angle = [](double t) {
    const double there = kTwoPi / 7.2 * t;
    return std::min(there, kTwoPi / 7.2 * 24.0 - there);
  };
  Capture c = bench.capture(12000, 500.0, 2, [&](double t) {
    return angle(t) + (t * 500.0 > static_cast<double>(at) - 0.5 ? slip : 0.0);
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(angle(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *found = named(d, "angle-slip");
  ASSERT_TRUE(found) << names(d);
  EXPECT_NEAR(found->values[1] * kRadPerDeg, slip, 0.05 * slip);
}

/// VDD is read with as much noise as the pair, which follows the supply and not that noise.
KIND(the_noise_of_a_recorded_supply_is_no_excess_of_the_pair) {
  Bench bench;
  bench.pair.noise_v = bench.within(1e-3, 2e-3);
  const double sag = bench.within(0.01, 0.03), slow_hz = bench.within(0.1, 0.3),
               converter_v = bench.pair.noise_v;
  Capture c = bench.capture(8000, 200.0, 1,
                            wandering(bench, bench.within(1.0, 2.0), 0.5, bench.within(0.05, 0.1)));
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double scale = 1.0 + sag * std::sin(kTwoPi * slow_hz * c.time_s[i]);
    c.vsin_v[i] *= scale;
    c.vcos_v[i] *= scale;
    c.vdd_v.push_back(5.0 * scale + bench.normal(converter_v));
  }
  c.reference_deg.clear();
  c.meta.noise_rms_v = 1.01 * bench.pair.noise_v;
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  ASSERT_TRUE(named(d, "supply-variation")) << names(d);
  expect_none(d, {"excess-noise", "amplitude-noise"});
}

/// Fifty hertz and 33 1/3 turns a minute: the hum comes ninety times a turn, for as long as the
/// platter keeps its speed. No cause that goes with the angle makes a line there by itself.
KIND(a_hum_that_keeps_step_with_a_platter_is_one) {
  Bench bench;
  constexpr int kPoles = 16;
  const double hz = 50.0 / 90.0 * (1.0 + bench.within(-1e-5, 1e-5)),
               ripple = bench.within(0.03, 0.15) * kRadPerDeg, phase = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(20000, 1000.0, kPoles, [=](double t) {
    const double even = kTwoPi * hz * t;
    return even + ripple * std::sin(3.0 * even + phase);
  });
  const double sin_v = bench.within(3.0, 6.0) * bench.pair.noise_v, cos_v = 0.8 * sin_v,
               start = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] += sin_v * std::sin(kTwoPi * 50.0 * c.time_s[i] + phase);
    c.vcos_v[i] += cos_v * std::sin(kTwoPi * 50.0 * c.time_s[i] + phase + 0.3 * start);
  }
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *tone = named(d, "periodic-interference");
  ASSERT_TRUE(tone) << names(d);
  EXPECT_NEAR(tone->values[0], 50.0, 0.01);
  EXPECT_NEAR(tone->values[1], sin_v, 0.1 * sin_v);
}

/// A microcontroller scans sine, cosine and a thermistor: what VCOS keeps of VSIN looks like a
/// quadrature error, and what VTEMP keeps of VCOS says how much it is.
KIND(a_memory_that_vtemp_measures_is_one_beside_a_smooth_motion) {
  Bench bench;
  const double m = bench.within(0.006, 0.02);
  Capture c = bench.capture(9000, 500.0, 1,
                            wandering(bench, bench.within(1.5, 3.0), 0.3, bench.within(0.1, 0.2)));
  double held = 1.6;
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] += m * (held - c.vsin_v[i]);
    c.vcos_v[i] += m * (c.vsin_v[i] - c.vcos_v[i]);
    held = 1.6 + bench.normal(3e-4);
    held += m * (c.vcos_v[i] - held);
    c.vtemp_v.push_back(held);
  }
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  const Finding *memory = named(d, "multiplexer-memory");
  ASSERT_TRUE(memory) << names(d);
  EXPECT_NEAR(memory->values[0], m, 0.05 * m);
  expect_pair(d, bench.pair, 0.002);
}

/// VDD is noisy and the pair follows it: what the channels have beyond what is stated is theirs.
KIND(an_excess_is_one_where_the_pair_follows_a_noisy_supply) {
  Bench bench;
  bench.pair.noise_v = bench.within(5e-4, 1e-3);
  const double more = bench.within(1.0, 2.0) * bench.pair.noise_v;
  Capture c = bench.capture(8000, 1000.0, 1,
                            wandering(bench, bench.within(2.0, 4.0), 0.3, bench.within(0.05, 0.1)));
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double vdd = 5.0 + bench.normal(4e-3);
    for (auto *v : {&c.vsin_v, &c.vcos_v})
      (*v)[i] = (*v)[i] * vdd / 5.0 + bench.normal(more);
    c.vdd_v.push_back(vdd);
  }
  c.reference_deg.clear();
  c.meta.noise_rms_v = bench.pair.noise_v;
  const Diagnosis d = diagnose(c, {});
  const Finding *excess = named(d, "excess-noise");
  ASSERT_TRUE(excess) << names(d);
  EXPECT_NEAR(excess->values[0], more, 0.05 * more);
}

/// Torque turns round where a shaft does, and there a magnet slips: behind the way over which a
/// play is taken up it is a slip.
KIND(a_slip_behind_a_reversal_is_one) {
  Bench bench;
  const double slip = bench.within(0.5, 4.0) * kRadPerDeg, rate = kTwoPi / 6.0;
  const double behind = (bench.within(0.0, 1.0) < 0.5 ? -1.0 : 1.0) * bench.within(2.0, 4.0) * slip;
  const auto angle = [=](double t) { return rate * std::min(t, 20.0 - t); };
  const double at_s = 10.0 + behind / rate;
  Capture c =
      bench.capture(10000, 500.0, 2, [&](double t) { return angle(t) + (t > at_s ? slip : 0.0); });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(angle(c.time_s[i]) * kDegPerRad, 360.0);
  const Diagnosis d = diagnose(c, {});
  const Finding *found = named(d, "angle-slip");
  ASSERT_TRUE(found) << names(d);
  EXPECT_NEAR(found->values[1] * kRadPerDeg, slip, 0.05 * slip);
  expect_none(d, {"propagation-delay", "reference-delay"});
}

/// A ripple that both see, and that the encoder's steps hide, is no error of either.
KIND(a_ripple_within_a_step_of_the_encoder_is_no_error_of_the_field) {
  Bench bench;
  const int counts = bench.within(0.0, 1.0) < 0.5 ? 256 : 1024;
  const double order = std::round(bench.within(1.5, 12.5)), hz = bench.within(1.0, 4.0),
               ripple = bench.within(0.03, 0.06) * kTwoPi / counts;
  const auto even = wandering(bench, hz, 0.3, bench.within(0.1, 0.3));
  const auto angle = [=](double t) { return even(t) + ripple * std::sin(order * even(t)); };
  Capture c = bench.capture(15000, 1000.0, 2, angle);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] =
        360.0 / counts * std::floor(wrap(angle(c.time_s[i]), kTwoPi) / kTwoPi * counts);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair, 0.002);
  expect_none(d, {"field-direction-error", "stray-field", "sensor-off-axis", "reference-harmonic",
                  "reference-eccentricity"});
}

/// A magnet that slips twice, by no whole number of rows: no loss, or one that a slip is named
/// beside.
KIND(two_slips_are_no_loss_without_an_alternative) {
  Bench bench;
  const double hz = bench.within(4.0, 6.0), slip = bench.within(7.0, 9.0) * kRadPerDeg;
  const double rows = slip / (kTwoPi * hz / 1000.0);
  const double whole = std::abs(rows - std::round(rows));
  const double by =
      whole > 0.3 ? slip : slip + 0.5 * kTwoPi * hz / 1000.0 * (whole < 0.2 ? 1.0 : 0.4);
  Capture c = bench.capture(20000, 1000.0, 2, [&](double t) {
    return kTwoPi * hz * t + (t > 6.0 ? by : 0.0) + (t > 13.0 ? by : 0.0);
  });
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  if (const Finding *loss = named(d, "sample-loss")) {
    EXPECT_EQ(std::count(loss->alternatives.begin(), loss->alternatives.end(), "angle-slip"), 1)
        << names(d);
  }
}

/// A channel's own sixth harmonic keeps step with the shaft, and is in that channel alone.
KIND(a_harmonic_of_one_channel_is_no_tone) {
  Bench bench;
  const double hz = bench.within(1.5, 3.0), phase = bench.within(0.0, kTwoPi),
               size = bench.within(0.002, 0.004) * bench.pair.amplitude_v;
  const auto angle = [=](double t) { return kTwoPi * hz * t; };
  Capture c = bench.capture(20000, 1000.0, 2, angle);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.vsin_v[i] += size * std::cos(6.0 * (2.0 * angle(c.time_s[i]) + bench.pair.zero_rad) + phase);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair);
  const Finding *f = named(d, "harmonic-distortion");
  ASSERT_TRUE(f) << names(d);
  EXPECT_EQ(f->values[0], 6.0);
  expect_none(d, {"periodic-interference"});
}

/// What an encoder of twelve bits rounds is less than the noise of a row, and at a steady speed the
/// same in each turn: some order of the turn has it.
KIND(the_last_count_of_an_encoder_is_no_harmonic_of_it) {
  Bench bench;
  bench.pair.noise_v = bench.within(1.5e-3, 3e-3);
  constexpr double kCounts = 4096.0;
  const double rows = std::round(bench.within(150.0, 400.0)), sense_s = 10.0;
  const auto angle = [=](double t) { // there and back, as many rows in each turn
    return kTwoPi * 1000.0 / rows * (t < sense_s ? t : 2.0 * sense_s - t);
  };
  Capture c = bench.capture(20000, 1000.0, 2, angle);
  for (double &r : c.reference_deg)
    r = 360.0 / kCounts * std::floor(r / 360.0 * kCounts);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair, 0.002);
  expect_none(d, {"reference-harmonic", "field-direction-error"});
}

/// Three speeds, one of them backwards, that change within a tenth of a second.
std::function<double(double)> plateaus(double a, double b, double c, double each_s) {
  constexpr double kChange_s = 0.1;
  return [=](double t) {
    const double speeds[] = {a, b, c};
    double angle = 0.0, from = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double begin = k * each_s, change = k == 0 ? 0.0 : kChange_s;
      const double in = std::clamp(t - begin, 0.0, each_s), rise = std::min(in, change);
      if (change > 0.0) // the speed goes up in a line
        angle += from * rise + 0.5 * (speeds[k] - from) * rise * rise / change;
      angle += speeds[k] * (in - rise);
      from = speeds[k];
    }
    return angle;
  };
}

/// An encoder off centre that is latched before the signals are taken: what it errs by is read
/// where the shaft then is, and the speed that its delay is one of is the shaft's, not its own.
KIND(an_encoder_off_centre_that_is_read_early_is_off_centre) {
  Bench bench;
  const auto angle = plateaus(kTwoPi * bench.within(4.0, 7.0), kTwoPi * bench.within(26.0, 36.0),
                              -kTwoPi * bench.within(12.0, 16.0), 1.3);
  const double early_s = bench.within(1e-4, 4e-4), e = bench.within(0.08, 0.2) * kRadPerDeg;
  const double phase = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(19000, 5000.0, 2, angle);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double then = angle(c.time_s[i] - early_s);
    c.reference_deg[i] = wrap((then + e * std::sin(then + phase)) * kDegPerRad, 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "reference-eccentricity");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], e * kDegPerRad, 4.0 * f->std_errors[0] + 1e-3) << names(d);
  const Finding *delay = named(d, "reference-delay");
  ASSERT_TRUE(delay) << left_of(d);
  EXPECT_NEAR(delay->values[0], -early_s, 4.0 * delay->std_errors[0] + 1e-7) << names(d);
  expect_none(d, {"stray-field", "sensor-off-axis", "field-direction-error", "reference-harmonic"});
}

/// A temperature that wanders as fast as the shaft turns, so that no spline leaves noise alone of
/// it, hides no memory by which VTEMP carries the angle.
KIND(a_memory_shows_in_a_vtemp_that_wanders) {
  Bench bench;
  bench.pair.k = bench.pair.delta_rad = 0.0;
  Capture c = bench.capture(18000, 1000.0, 1,
                            plateaus(kTwoPi * 0.4, kTwoPi * bench.within(0.8, 1.5),
                                     -kTwoPi * bench.within(0.4, 0.8), 6.0));
  c.reference_deg.clear();
  const double m = bench.within(0.006, 0.02), step_v = bench.within(8e-5, 1.5e-4);
  double temperature_v = 1.6, before_v = temperature_v;
  for (std::size_t i = 0; i < c.size(); ++i) {
    temperature_v += bench.normal(step_v);
    c.vsin_v[i] += m * (before_v - c.vsin_v[i]);
    c.vcos_v[i] += m * (c.vsin_v[i] - c.vcos_v[i]);
    before_v = temperature_v + bench.normal(5e-4);
    before_v += m * (c.vcos_v[i] - before_v);
    c.vtemp_v.push_back(before_v);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "multiplexer-memory");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], m, 4.0 * f->std_errors[0] + 2e-5) << names(d);
  expect_none(d, {"quadrature-error", "offset-temperature-drift"});
}

/// An encoder of twenty thousand counts beside a quiet pair: what its last count leaves is no noise
/// of the angle.
KIND(the_last_count_of_an_encoder_is_no_noise_of_the_angle) {
  Bench bench;
  const double rpm = bench.within(80.0, 400.0), slower = bench.within(0.4, 0.8);
  const double count_deg = 360.0 / (bench.within(0.0, 1.0) < 0.5 ? 20000.0 : 40000.0);
  const int periods = count_deg > 0.01 ? 2 : 12;
  Capture c = bench.capture(15000, 1000.0, periods, [=](double t) {
    return kTwoPi * rpm / 60.0 * (t - 0.5 * (1.0 - slower) * t * t / 15.0);
  });
  for (double &r : c.reference_deg)
    r = wrap(count_deg * std::floor(r / count_deg), 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"angle-noise", "timing-jitter"});
  expect_pair(d, bench.pair, 0.002);
}

/// A field that is told its angles, one step a row, and a pair whose map has steps as wide: it is
/// not the reference that is coarse.
KIND(an_angle_that_is_told_row_by_row_is_no_coarse_reference) {
  Bench bench;
  constexpr double kRows = 2000.0, kStep = kTwoPi / kRows;
  const double e = bench.within(0.5, 1.5) * kRadPerDeg, phase = bench.within(0.0, kTwoPi);
  const double from = bench.within(0.0, 1.0);
  Capture c = bench.capture(2000, kRows, 2, [=](double t) {
    const double a = kTwoPi * t;
    return kStep * std::floor((a + e * std::sin(4.0 * a + phase)) / kStep + from);
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = 360.0 / kRows * static_cast<double>(i);
  expect_none(diagnose(c, {}), {"reference-resolution"});
}

/// A heat that comes and goes with the electrical period, late by its own time constant, is in
/// VTEMP with both channels: a memory gives it VCOS alone.
KIND(a_heat_wave_of_the_electrical_period_is_no_memory) {
  Bench bench;
  bench.pair.delta_rad = 0.0; // which a memory would have to hide
  const double hz = bench.within(0.4, 1.2), late = bench.within(0.4, 1.2);
  Capture c = bench.capture(20000, 500.0, 1, [=](double t) { return kTwoPi * hz * t; });
  c.reference_deg.clear();
  const double wave_v = bench.within(0.005, 0.02);
  for (const double t : c.time_s)
    c.vtemp_v.push_back(1.6 + wave_v * std::cos(kTwoPi * hz * t + bench.pair.zero_rad - late) +
                        bench.normal(4e-4));
  expect_none(diagnose(c, {}), {"multiplexer-memory", "quadrature-error"});
}

/// A table that stops at whole and half degrees, and vibrates there: its places are no rounding
/// that could be what the angle scatters by.
KIND(a_table_that_vibrates_at_its_places_has_a_noisy_angle) {
  Bench bench;
  bench.pair.noise_v = bench.within(3e-4, 6e-4);
  const double place_deg = bench.within(0.0, 1.0) < 0.5 ? 0.5 : 1.0;
  const double vibrates = bench.within(0.15, 0.3) * place_deg;
  constexpr int kReadings = 8;
  std::vector<double> shaft_deg;
  for (int i = 0; i < 720 * kReadings; ++i)
    shaft_deg.push_back(place_deg * (i / kReadings) + bench.normal(vibrates));
  Capture c = bench.capture(shaft_deg.size(), 200.0, 2, [&](double t) {
    return shaft_deg[static_cast<std::size_t>(std::lround(t * 200.0))] * kRadPerDeg;
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] =
        wrap(place_deg * static_cast<double>(i / static_cast<std::size_t>(kReadings)), 360.0);
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "angle-noise");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], vibrates, 4.0 * f->std_errors[0] + 0.02 * vibrates) << names(d);
}

/// An encoder whose interpolation errs forty times a turn and which is read early, up to speeds at
/// which the speed that it shows is a mean over a good part of such a wave.
KIND(a_fast_ripple_of_an_encoder_beside_its_delay_has_its_size) {
  Bench bench;
  constexpr int kOrder = 40;
  const double slow_hz = bench.within(3.0, 6.0), fast_hz = bench.within(20.0, 28.0);
  constexpr double kLong_s = 2.0;
  const auto angle = [=](double t) {
    return kTwoPi * (slow_hz * t + 0.5 * (fast_hz - slow_hz) / kLong_s * t * t);
  };
  const double early_s = bench.within(1e-4, 3e-4), e = bench.within(0.1, 0.2) * kRadPerDeg;
  const double phase = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(20000, 20000.0 / kLong_s, 2, angle);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double then = angle(c.time_s[i] - early_s);
    c.reference_deg[i] = wrap((then + e * std::sin(kOrder * then + phase)) * kDegPerRad, 360.0);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "reference-harmonic");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], kOrder, 0.01) << names(d);
  EXPECT_NEAR(f->values[1], e * kDegPerRad, 0.02 * e * kDegPerRad) << names(d);
  const Finding *delay = named(d, "reference-delay");
  ASSERT_TRUE(delay) << left_of(d);
  EXPECT_NEAR(delay->values[0], -early_s, 0.02 * early_s) << names(d);
}

/// A motor that keeps the angle even which the pair itself reads, with all errors of its ellipse:
/// the shaft ripples by these, and the ellipse is as it is.
KIND(a_shaft_that_its_own_pair_regulates_ripples_and_blames_no_field) {
  Bench bench;
  const double hz = bench.within(3.0, 8.0), sin_v = 2.5 + bench.within(0.02, 0.06),
               cos_v = 2.5 - bench.within(0.02, 0.06);
  bench.pair.zero_rad = 0.0;
  const auto read = [&](double psi, double &s, double &c) {
    s = sin_v + bench.pair.amplitude_v * (1.0 + 0.5 * bench.pair.k) *
                    std::sin(psi + 0.5 * bench.pair.delta_rad);
    c = cos_v + bench.pair.amplitude_v * (1.0 - 0.5 * bench.pair.k) *
                    std::cos(psi - 0.5 * bench.pair.delta_rad);
  };
  Capture c = bench.capture(20000, 1000.0, 1, [](double) { return 0.0; });
  c.reference_deg.clear();
  for (std::size_t i = 0; i < c.size(); ++i) {
    // The angle at which the raw reading is even.
    const double wanted = kTwoPi * hz * c.time_s[i];
    double psi = wanted, s = 0.0, co = 0.0;
    for (int pass = 0; pass < 30; ++pass) {
      read(psi, s, co);
      psi += wrap_centred(wanted - std::atan2(s - 2.5, co - 2.5), kTwoPi);
    }
    read(psi, s, co);
    c.vsin_v[i] = s + bench.normal(bench.pair.noise_v);
    c.vcos_v[i] = co + bench.normal(bench.pair.noise_v);
  }
  const Diagnosis d = diagnose(c, {});
  expect_none(d, {"stray-field", "sensor-off-axis", "field-direction-error"});
  EXPECT_TRUE(named(d, "rotation-nonuniformity")) << left_of(d);
}

/// Beside a quadrature error and a skew the pair alone shows no memory: VTEMP does.
KIND(a_memory_that_only_vtemp_shows_is_named) {
  Bench bench;
  const double m = bench.within(0.005, 0.012), late_s = bench.within(4e-5, 8e-5);
  const auto turn = plateaus(kTwoPi * bench.within(3.0, 6.0), kTwoPi * bench.within(8.0, 14.0),
                             -kTwoPi * bench.within(5.0, 12.0), 3.0);
  Capture c = bench.capture(18000, 2000.0, 2, turn),
          later = bench.capture(18000, 2000.0, 2, [&](double t) { return turn(t + late_s); });
  c.vcos_v = later.vcos_v;
  c.reference_deg.clear();
  double before_v = 1.6;
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] += m * (before_v - c.vsin_v[i]);
    c.vcos_v[i] += m * (c.vsin_v[i] - c.vcos_v[i]);
    before_v = 1.6 + bench.normal(2e-4);
    before_v += m * (c.vcos_v[i] - before_v);
    c.vtemp_v.push_back(before_v);
  }
  const Diagnosis d = diagnose(c, {});
  const Finding *f = named(d, "multiplexer-memory");
  ASSERT_TRUE(f) << left_of(d);
  EXPECT_NEAR(f->values[0], m, 4.0 * f->std_errors[0] + 1e-4) << names(d);
  expect_pair(d, bench.pair);
}

/// A belt whose wheels have nearly as many teeth: its error has an order of the turn beside one.
KIND(a_gear_of_nearly_one_turn_a_turn_is_no_eccentricity) {
  Bench bench;
  const double order =
                   bench.within(0.0, 1.0) < 0.5 ? bench.within(0.8, 0.92) : bench.within(1.08, 1.2),
               size_deg = bench.within(0.15, 0.35), phase = bench.within(0.0, kTwoPi);
  const double hz = bench.within(3.0, 6.0), swing = bench.within(0.1, 0.3);
  const auto turn = [&](double t) {
    return kTwoPi * (hz * t + swing * std::sin(0.9 * t) + 0.5 * swing * std::sin(2.3 * t));
  };
  Capture c = bench.capture(16000, 1000.0, 2, turn);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] =
        wrap(c.reference_deg[i] + size_deg * std::sin(order * turn(c.time_s[i]) + phase), 360.0);
  const Diagnosis d = diagnose(c, {});
  // Nearer than eight periods over the record the sides of an eccentricity whose size comes and
  // goes look the same: it is left without a name, and nothing else is named for it.
  constexpr double kRecord_s = 16.0, kPeriodsApart = 8.5; // the swing is of the turns as well
  const Finding *f = named(d, "reference-harmonic");
  const bool apart = std::abs(order - 1.0) * hz * kRecord_s > kPeriodsApart;
  ASSERT_TRUE(f || !apart) << left_of(d);
  expect_pair(d, bench.pair);
  expect_none(d, {"reference-eccentricity", "stray-field"});
  if (!f)
    return;
  EXPECT_NEAR(f->values[0], order, 1e-3) << names(d);
  EXPECT_NEAR(f->values[1], size_deg, 4.0 * f->std_errors[1] + 1e-3) << names(d);
}

/// A tool with a magnet passes the bench once: what that does repeats with no angle.
KIND(a_magnet_that_passes_once_is_no_matter_of_the_angle) {
  Bench bench;
  const double at_s = bench.within(4.0, 14.0), long_s = bench.within(0.05, 0.2),
               b = bench.within(0.01, 0.03), from = bench.within(0.0, kTwoPi),
               hz = bench.within(2.0, 5.0);
  Capture c = bench.capture(20000, 1000.0, 2, [&](double t) {
    const double shaft = kTwoPi * hz * t, u = (t - at_s) / long_s;
    return shaft + b * std::exp(-0.5 * u * u) * std::sin(from - shaft);
  });
  for (std::size_t i = 0; i < c.size(); ++i)
    c.reference_deg[i] = wrap(360.0 * hz * c.time_s[i], 360.0);
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(d.extended.remainder) << left_of(d);
  for (const Structure &s : d.structure)
    EXPECT_EQ(s.description.find("repeat with the angle"), std::string::npos) << s.description;
}

/// The mains in a supply that nobody recorded, while the shaft turns at three speeds, of which one
/// makes it come again at the same places of the turn.
KIND(a_ripple_of_the_supply_repeats_with_no_angle) {
  Bench bench;
  const double depth = bench.within(0.002, 0.006), phase = bench.within(0.0, kTwoPi);
  Capture c = bench.capture(20000, 1000.0, 2,
                            plateaus(kTwoPi * 5.0, kTwoPi * bench.within(6.7, 7.4),
                                     -kTwoPi * bench.within(2.7, 3.2), 20.0 / 3.0));
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double supply = 1.0 + depth * std::sin(kTwoPi * 50.0 * c.time_s[i] + phase);
    c.vsin_v[i] *= supply;
    c.vcos_v[i] *= supply;
  }
  const Diagnosis d = diagnose(c, {});
  EXPECT_FALSE(d.extended.remainder) << left_of(d);
  expect_pair(d, bench.pair);
}

/// A magnet with lobes: its strength goes with the angle, its direction does not. Errors of the
/// field, of the chain and of the reference that take each other back in the angle would make the
/// same length, and there is none of them. Two lobes a turn are left out: with one period a turn
/// they are an ellipse together with a sensor off its axis.
KIND(a_magnet_with_lobes_errs_in_length_alone) {
  Bench bench;
  bench.pair.noise_v = 6e-4;
  Capture c = bench.capture(2000, 100.0, 1,
                            [](double t) { return kTwoPi * (1.2 * t + 0.05 * std::sin(0.7 * t)); });
  const double three = bench.within(0.01, 0.03), four = bench.within(0.005, 0.02),
               at_three = bench.within(0.0, kTwoPi), at_four = bench.within(0.0, kTwoPi);
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double a = c.reference_deg[i] * kRadPerDeg;
    const double by = three * std::cos(3.0 * a + at_three) + four * std::cos(4.0 * a + at_four);
    c.vsin_v[i] += by * (c.vsin_v[i] - kMiddleV);
    c.vcos_v[i] += by * (c.vcos_v[i] - kMiddleV);
  }
  const Diagnosis d = diagnose(c, {});
  for (const Finding &f : d.findings)
    EXPECT_EQ(f.effect->info().prior_rank, 0) << names(d);
  expect_pair(d, bench.pair, 2e-3);
}

/// A reference of a degree of noise hides a small mismatch in the angle, and not in the length.
KIND(a_noisy_reference_hides_nothing_that_the_length_shows) {
  Bench bench;
  bench.pair.k = bench.within(0.006, 0.012) * (bench.within(0.0, 1.0) < 0.5 ? -1.0 : 1.0);
  const double swing = bench.within(4.0, 8.0);
  Capture c = bench.capture(700, 20.0, 2, [&](double t) {
    return kTwoPi * (0.3 * t + 0.02 * swing * std::sin(0.8 * t));
  });
  const double noise_deg = bench.within(0.8, 1.3);
  for (double &r : c.reference_deg)
    r = wrap(r + bench.normal(noise_deg), 360.0);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair, 1e-3);
}

/// Jumps of a reference that take each other back: each alone makes the rest of the record worse.
KIND(jumps_that_take_each_other_back_are_each_found) {
  Bench bench;
  Capture c = bench.capture(16000, 1000.0, 2, [](double t) { return kTwoPi * 4.3 * t; });
  const double step_deg = bench.within(8.0, 20.0);
  const double at[] = {bench.within(2.0, 4.0), bench.within(5.0, 7.0), bench.within(9.0, 11.0),
                       bench.within(12.0, 14.0)};
  const double by[] = {step_deg, -0.8 * step_deg, 1.1 * step_deg, -1.2 * step_deg};
  for (std::size_t i = 0; i < c.size(); ++i)
    for (int k = 0; k < 4; ++k)
      if (c.time_s[i] >= at[k])
        c.reference_deg[i] = wrap(c.reference_deg[i] + by[k], 360.0);
  const Diagnosis d = diagnose(c, {});
  int found = 0;
  for (const Finding &f : d.findings)
    for (int k = 0; k < 4 && f.effect->info().id == "angle-slip"; ++k)
      if (std::abs(f.values[0] - at[k]) < 0.02) {
        ++found;
        EXPECT_NEAR(f.values[1], -by[k], 0.1) << names(d);
      }
  EXPECT_EQ(found, 4) << names(d);
  expect_pair(d, bench.pair, 1e-3);
}

/// A ring that is worn at one place: a contact opens and bounces there in every turn. A magnet does
/// not take a channel to a rail, so these rows say nothing of the angle.
KIND(a_contact_that_opens_at_one_place_of_the_turn_bends_no_fit) {
  Bench bench;
  Capture c = bench.capture(16000, 1000.0, 2,
                            [](double t) { return kTwoPi * 2.0 * (t + 0.4 * std::sin(0.9 * t)); });
  const double from_deg = bench.within(0.0, 340.0), rail_v = bench.within(0.02, 0.1);
  const bool sine = bench.within(0.0, 1.0) < 0.5;
  for (std::size_t i = 0; i < c.size(); ++i)
    if (wrap(c.reference_deg[i] - from_deg, 360.0) < 10.0 && bench.within(0.0, 1.0) < 0.7)
      (sine ? c.vsin_v : c.vcos_v)[i] = rail_v + bench.normal(0.005);
  const Diagnosis d = diagnose(c, {});
  expect_pair(d, bench.pair, 1e-3);
  EXPECT_EQ(d.findings.size(), 2u) << names(d);
  EXPECT_EQ(d.verdict, Verdict::partly_explained);
}

} // namespace
} // namespace ada::test
