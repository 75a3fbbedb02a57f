// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What real benches add: references that err, wander and noise. Each simulated capture is held
// against the one of the same seed without the effect, whose white noise is the same, by a formula
// of the test's own.

#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <unsupported/Eigen/FFT>

#include "base/angle.h"
#include "model/effect_text.h"
#include "model/forward.h"
#include "simulation/generator.h"
#include "support/seed.h"

namespace ada {
namespace {

SimulationOptions options_with(const std::string &motion, double noise_v = 0.0) {
  SimulationOptions o;
  o.sample_rate_hz = 4096.0;
  o.duration_s = 8.0;
  o.noise_rms_v = noise_v;
  o.adc_bits = 0;
  o.motion = motion;
  return o;
}

struct Pair {
  Model model; ///< with the effect
  Capture clean, with;
};

Pair captures(const std::string &effect, const SimulationOptions &options, std::uint64_t seed) {
  Pair out;
  out.model = sound_sensor(seed, 5.0, true);
  out.clean = Simulation(out.model, options, seed).run();
  add_effect(out.model, parse_effect(effect));
  out.with = Simulation(out.model, options, seed).run();
  EXPECT_EQ(out.clean.time_s, out.with.time_s);
  return out;
}

/// The vector of a sample about the centre of its circle.
std::complex<double> vector_of(const Pair &p, const Capture &c, std::size_t i) {
  const Baseline &b = p.model.baseline;
  return {c.vcos_v[i] - 2.5 - b.offset_cos_v, c.vsin_v[i] - 2.5 - b.offset_sin_v};
}

/// Reference of the first capture counted on over the turns, degrees.
std::vector<double> unwrapped(const Capture &c) {
  std::vector<double> out = c.reference_deg;
  for (std::size_t i = 1; i < out.size(); ++i)
    out[i] = out[i - 1] + std::remainder(out[i] - out[i - 1], 360.0);
  return out;
}

double rms(const std::vector<double> &x) {
  double sum = 0.0;
  for (const double v : x)
    sum += v * v;
  return std::sqrt(sum / static_cast<double>(x.size()));
}

/// Part by which an rms of so many normal numbers may be off: five standard errors.
double five_sigma(std::size_t n) {
  return 5.0 / std::sqrt(2.0 * static_cast<double>(n));
}

/// The model's way back from what the reference reads to the shaft, degrees.
std::vector<double> shaft_behind(const Pair &p, double acceleration) {
  std::vector<double> angle = unwrapped(p.with);
  const double turn = 360.0 * std::round((p.clean.reference_deg[0] - angle[0]) / 360.0);
  for (double &a : angle) // the error must not put the beginning into another turn
    a += turn;
  const std::size_t n = angle.size();
  std::vector<double> alpha(n), out(n);
  std::vector<float> omega(n), accel(n, static_cast<float>(acceleration));
  for (std::size_t i = 0; i < n; ++i)
    alpha[i] = angle[i] * kRadPerDeg;
  for (std::size_t i = 1; i + 1 < n; ++i)
    omega[i] = static_cast<float>((alpha[i + 1] - alpha[i - 1]) /
                                  (p.with.time_s[i + 1] - p.with.time_s[i - 1]));
  omega[0] = omega[1];
  omega[n - 1] = omega[n - 2];
  const Conditions at{.n = n,
                      .time = p.with.time_s.data(),
                      .alpha = alpha.data(),
                      .omega = omega.data(),
                      .accel = accel.data()};
  ForwardModel(p.model, AlphaIs::reference).magnet_angle(at, out.data());
  for (double &a : out)
    a *= kDegPerRad;
  return out;
}

TEST(ReferenceHarmonic, ReadsTheSineOfItsOrderOverTheTurnsAndIsTakenOutAgain) {
  for (const double order : {8.0, 7.25, 64.0}) {
    const Pair p =
        captures("reference-harmonic:order=" + std::to_string(order) + ",e_deg=0.3,phase_deg=40",
                 options_with("steps:rpm=60/300/-90"), test::fresh_seed());
    EXPECT_EQ(p.with.vsin_v, p.clean.vsin_v);
    const std::vector<double> alpha = unwrapped(p.clean), back = shaft_behind(p, 0.0);
    for (std::size_t i = 0; i < alpha.size(); ++i) {
      const double e = 0.3 * std::sin((order * alpha[i] + 40.0) * kRadPerDeg);
      // Ten turns of 360 degrees in doubles: 1e-12; the sine multiplies it by the order.
      ASSERT_NEAR(std::remainder(p.with.reference_deg[i] - alpha[i], 360.0), e, 1e-9) << i;
      ASSERT_NEAR(std::remainder(back[i] - alpha[i], 360.0), 0.0, 1e-6)
          << i; // the passes end there
    }
  }
}

TEST(ReferenceDelay, ReadsTheAngleOfTauLaterAndIsTakenOutAgain) {
  for (const double tau : {2e-3, -2e-3}) {
    SimulationOptions o = options_with("ramp:from=60,to=540"); // 60 rpm more each second
    const Pair p = captures("reference-delay:tau_s=" + std::to_string(tau), o, test::fresh_seed());
    EXPECT_EQ(p.with.vsin_v, p.clean.vsin_v);
    const std::vector<double> alpha = unwrapped(p.clean),
                              back = shaft_behind(p, kTwoPi); // 1 turn/s^2
    for (std::size_t i = 0; i < alpha.size(); ++i) {
      const double t = p.clean.time_s[i];
      const auto at = [](double x) { return 360.0 * (x + 0.5 * x * x); };
      // The speed is a float: 24 bits of what the shaft turns in tau.
      const double rounding = std::abs(at(t + tau) - at(t)) * std::ldexp(1.0, -24) + 1e-9;
      ASSERT_NEAR(std::remainder(p.with.reference_deg[i] - alpha[i], 360.0), at(t + tau) - at(t),
                  2.0 * rounding)
          << i;
      if (i == 0 || i + 1 == alpha.size())
        continue;
      // The test takes the speed from neighbours, which are each off by as much.
      const double step_s = p.clean.time_s[1] - p.clean.time_s[0];
      ASSERT_NEAR(std::remainder(back[i] - alpha[i], 360.0), 0.0,
                  (2.0 + std::abs(tau) / step_s) * rounding)
          << i;
    }
  }
}

TEST(ReferenceErrors, ComeApartInTheReverseOfTheirOrder) {
  const std::uint64_t seed = test::fresh_seed();
  Pair p = captures("reference-harmonic:order=32,e_deg=0.2,phase_deg=10",
                    options_with("constant:rpm=120"), seed);
  add_effect(p.model, parse_effect("reference-eccentricity:e_deg=0.5,phase_deg=70"));
  add_effect(p.model, parse_effect("reference-delay:tau_s=1e-4"));
  p.with = Simulation(p.model, options_with("constant:rpm=120"), seed).run();
  const std::vector<double> alpha = unwrapped(p.clean), back = shaft_behind(p, 0.0);
  for (std::size_t i = 1; i + 1 < alpha.size(); ++i)
    // The reference's own speed scatters by e n = 0.11 of 720 deg/s, and so does tau times it.
    ASSERT_NEAR(std::remainder(back[i] - alpha[i], 360.0), 0.0, 0.13 * 720.0 * 1e-4) << i;
}

TEST(ReferenceResolution, ReadsTheNearestStep) {
  const Pair p = captures("reference-resolution:step_deg=0.5", options_with("steps:rpm=30/-30"),
                          test::fresh_seed());
  std::vector<double> off;
  for (std::size_t i = 0; i < p.with.size(); ++i) {
    const double r = p.with.reference_deg[i];
    ASSERT_NEAR(r, 0.5 * std::round(2.0 * r), 1e-9);
    off.push_back(std::remainder(r - p.clean.reference_deg[i], 360.0));
    ASSERT_LE(std::abs(off.back()), 0.25 + 1e-9);
  }
  // Evenly over the step: 4096 samples a second over 720 steps a turn.
  EXPECT_NEAR(rms(off), 0.5 / std::sqrt(12.0), 0.01);
}

TEST(OffsetWander, IsASlowShiftOfTheStatedRms) {
  const Pair p = captures("offset-wander:rms_sin_v=0.003,rms_cos_v=0.001",
                          options_with("constant:rpm=120", 5e-4), test::fresh_seed());
  for (const bool sine : {true, false}) {
    std::vector<double> off;
    int crossings = 0;
    for (std::size_t i = 0; i < p.with.size(); ++i) {
      off.push_back(sine ? p.with.vsin_v[i] - p.clean.vsin_v[i]
                         : p.with.vcos_v[i] - p.clean.vcos_v[i]);
      crossings += i > 0 && off[i] * off[i - 1] < 0.0;
    }
    // The mean over 2000 points is the one over 32768 samples to the course's bend between them.
    EXPECT_NEAR(rms(off), sine ? 0.003 : 0.001, 1e-5);
    EXPECT_GE(crossings, 1);
    EXPECT_LE(crossings, 20); // a cosine of the highest frequency, 9.5 cycles, has 19
  }
  EXPECT_NE(p.with.vsin_v[0] - p.clean.vsin_v[0], p.with.vcos_v[0] - p.clean.vcos_v[0]);
}

TEST(GainWander, MovesTheRadiusSlowlyAndNotTheAngle) {
  const Pair p = captures("gain-wander:rms_fraction=0.01", options_with("constant:rpm=120", 5e-4),
                          test::fresh_seed());
  std::vector<double> gain;
  int crossings = 0;
  for (std::size_t i = 0; i < p.with.size(); ++i) {
    const std::complex<double> ratio = vector_of(p, p.with, i) / vector_of(p, p.clean, i);
    ASSERT_NEAR(ratio.imag(), 0.0, 1e-12);
    gain.push_back(ratio.real() - 1.0);
    crossings += i > 0 && gain[i] * gain[i - 1] < 0.0;
  }
  EXPECT_NEAR(rms(gain), 0.01, 3e-5);
  EXPECT_GE(crossings, 1);
  EXPECT_LE(crossings, 20);
}

TEST(Wander, RunsOnFromPartToPart) {
  const std::uint64_t seed = test::fresh_seed();
  Model model = sound_sensor(seed, 5.0, true);
  model.baseline = {1.0, 0.0, 0.0, 0.0};
  model.effects.clear();
  add_effect(model, parse_effect("gain-wander:rms_fraction=0.01"));
  Generator generator(Simulation(model, options_with("constant:rpm=120"), seed));
  std::vector<double> radius;
  for (int part = 0; part < 8; ++part) {
    const Capture c = generator.next(4096);
    for (std::size_t i = 0; i < c.size(); ++i)
      radius.push_back(std::hypot(c.vsin_v[i] - 2.5, c.vcos_v[i] - 2.5));
  }
  // Amplitudes are at most a few rms each, and turn by 2 pi 9.5 / 32768 a sample.
  for (std::size_t i = 1; i < radius.size(); ++i)
    ASSERT_LT(std::abs(radius[i] - radius[i - 1]), 0.01 * 20 * kTwoPi * 9.5 / 32768) << i;
}

TEST(AmplitudeNoise, LiesAlongTheVector) {
  const Pair p = captures("amplitude-noise:rms_fraction=0.002", options_with("constant:rpm=120"),
                          test::fresh_seed());
  std::vector<double> along;
  for (std::size_t i = 0; i < p.with.size(); ++i) {
    const std::complex<double> ratio = vector_of(p, p.with, i) / vector_of(p, p.clean, i);
    ASSERT_NEAR(ratio.imag(), 0.0, 1e-12);
    along.push_back(ratio.real() - 1.0);
  }
  EXPECT_NEAR(rms(along), 0.002, 0.002 * five_sigma(along.size()));
}

/// Mechanical turn of the vector, degrees; the radius stays.
std::vector<double> turns(const Pair &p) {
  std::vector<double> out;
  for (std::size_t i = 0; i < p.with.size(); ++i) {
    const std::complex<double> ratio = vector_of(p, p.with, i) / vector_of(p, p.clean, i);
    EXPECT_NEAR(std::abs(ratio), 1.0, 1e-12);
    out.push_back(std::arg(ratio) * kDegPerRad / p.model.periods_per_turn);
  }
  return out;
}

TEST(AngleNoise, LiesAcrossTheVectorAndStaysAtRest) {
  for (const char *motion : {"constant:rpm=120", "constant:rpm=0"}) {
    const auto across =
        turns(captures("angle-noise:rms_deg=0.05", options_with(motion), test::fresh_seed()));
    EXPECT_NEAR(rms(across), 0.05, 0.05 * five_sigma(across.size())) << motion;
  }
}

TEST(TimingJitter, IsAnAngleNoiseThatGrowsWithSpeed) {
  for (const double rpm : {0.0, 100.0, -800.0}) {
    const auto across =
        turns(captures("timing-jitter:rms_s=1e-5",
                       options_with("constant:rpm=" + std::to_string(rpm)), test::fresh_seed()));
    const double expected = std::abs(rpm) * 6.0 * 1e-5; // 6 degrees a second at one rpm
    EXPECT_NEAR(rms(across), expected, expected * five_sigma(across.size()) + 1e-12) << rpm;
  }
}

TEST(FlickerNoise, HasEqualPowerInEveryOctaveAndTheStatedRmsBelowTheCorner) {
  const double corner = 256.0, duration = 8.0;
  const Pair p = captures("flicker-noise:rms_v=0.002,corner_hz=256",
                          options_with("constant:rpm=120", 5e-4), test::fresh_seed());
  for (const bool sine : {true, false}) {
    const std::size_t n = p.with.size();
    ASSERT_EQ(n, 32768u);
    std::vector<double> off(n);
    for (std::size_t i = 0; i < n; ++i) // Hann's window: no leakage from one octave to another
      off[i] =
          (sine ? p.with.vsin_v[i] - p.clean.vsin_v[i] : p.with.vcos_v[i] - p.clean.vcos_v[i]) *
          (1.0 - std::cos(kTwoPi * static_cast<double>(i) / static_cast<double>(n)));
    std::vector<std::complex<double>> line;
    Eigen::FFT<double> fft;
    fft.fwd(line, off);
    const double expected = 0.002 * 0.002 / std::log(corner * duration) * std::log(2.0);
    for (std::size_t k = 64; k <= 1024; k *= 2) { // 8 Hz to 256 Hz, an octave each
      double power = 0.0;
      for (std::size_t j = k; j < 2 * k; ++j) // both signs of the frequency; 1.5: Hann's power
        power += 2.0 * std::norm(line[j]) / (1.5 * static_cast<double>(n) * static_cast<double>(n));
      // k lines of which the window leaves k/2 independent ones, with weights of 1 to 1/2: their
      // power scatters by 1.02 sqrt(2/k). What is folded back adds 2 % to the highest octave.
      EXPECT_NEAR(power, expected,
                  expected * (5.0 * 1.02 * std::sqrt(2.0 / static_cast<double>(k)) + 0.03))
          << "from " << static_cast<double>(k) / duration << " Hz";
    }
  }
}

} // namespace
} // namespace ada
