// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

/// \file
/// The engine's leading terms are those by which the effect catalogue defines its parameters.

#include "hidden_effects.h"
#include "random.h"
#include "scenario.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <sstream>

#include <gtest/gtest.h>

namespace truth {
namespace {

using Complex = std::complex<double>;

/// Fourier coefficient of exp(j order x) of a function over one turn of x.
Complex coefficient(const std::function<Complex(double)> &function, int order) {
  constexpr int kPoints = 720;
  Complex sum = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double x = kTurn * i / kPoints;
    sum += function(x) * std::polar(1.0, -order * x);
  }
  return sum / static_cast<double>(kPoints);
}

double sine_part(const std::function<double(double)> &function, int order) {
  return -2 * coefficient([&](double x) { return Complex(function(x)); }, order).imag();
}
double cosine_part(const std::function<double(double)> &function, int order) {
  return 2 * coefficient([&](double x) { return Complex(function(x)); }, order).real();
}

/// A capture without any noise, at constant speed.
Bench silent(double rpm, double rate = 5000, std::size_t samples = 5000, int periods = 2) {
  Bench bench;
  bench.samples = samples;
  bench.sampler.rate = rate;
  bench.sampler.jitter = 0.0;
  bench.bridge.periods_per_turn = periods;
  bench.motion.hold(bench.duration(), rpm * kRpm);
  bench.thermal.duration = bench.duration();
  bench.converter.bits = 40;
  bench.converter.noise = bench.converter.vtemp_noise = bench.converter.vdd_noise = 0.0;
  bench.record.reference_noise = 0.0;
  bench.chain.vtemp_centre = mean_vtemp(bench);
  return bench;
}

/// Amplitude and phase of a column at the electrical frequency, over whole turns.
Complex fundamental(const std::vector<double> &column, const Capture &capture, int periods) {
  Complex sum = 0.0;
  for (std::size_t i = 0; i < column.size(); ++i)
    sum += (column[i] - 2.5) * std::polar(1.0, -periods * capture.shaft[i]);
  return 2.0 * sum / static_cast<double>(column.size());
}

TEST(Motion, SpeedIsTheDerivativeOfAContinuousAngle) {
  Motion motion;
  motion.start_at(1.0);
  motion.hold(0.5, 10);
  motion.change(0.2, -20);
  motion.hold(0.1, -20);
  motion.ramp(0.3, 5);
  motion.coast(1.0, 0.4);
  motion.add_ripple({3, 0.01, 0.5});
  motion.add_wander({0.02, 7.0, 0.1});
  EXPECT_NEAR(motion.duration(), 2.1, 1e-12);
  constexpr double h = 1e-6;
  for (double t = -0.1; t < 2.3; t += 0.0137)
    EXPECT_NEAR((motion.angle(t + h) - motion.angle(t - h)) / (2 * h), motion.speed(t), 1e-4) << t;
}

TEST(Motion, AccelerationIsTheDerivativeOfTheSpeed) {
  Motion motion;
  motion.hold(0.5, 10);
  motion.change(0.2, -20);
  motion.ramp(0.3, 5);
  motion.coast(1.0, 0.4);
  constexpr double h = 1e-6;
  for (double t = 0.01; t < 1.9; t += 0.0137)
    EXPECT_NEAR((motion.speed(t + h) - motion.speed(t - h)) / (2 * h), motion.acceleration(t), 1e-3)
        << t;
}

TEST(Field, StrayFieldIsAVectorSum) {
  Field field;
  field.stray = 0.01;
  field.stray_direction = 0.7;
  const auto error = [&](double x) { return field.at(x).direction - x; };
  // b sin(gamma - alpha) = b sin(gamma) cos(alpha) - b cos(gamma) sin(alpha)
  EXPECT_NEAR(sine_part(error, 1), -0.01 * std::cos(0.7), 1e-9);
  EXPECT_NEAR(cosine_part(error, 1), 0.01 * std::sin(0.7), 1e-9);
  // -(b^2/2) sin 2(gamma - alpha)
  EXPECT_NEAR(sine_part(error, 2), 0.5e-4 * std::cos(1.4), 1e-9);
  EXPECT_NEAR(field.at(0.7).strength, 1.01, 1e-12);
}

TEST(Field, OffAxisErrorIsTheDipolesAndHasTheCataloguesSign) {
  Field field;
  field.off_axis = 0.005;
  field.off_axis_direction = 0.4;
  const auto error = [&](double x) { return field.at(x).direction - x; };
  // a sin 2(alpha - beta)
  EXPECT_NEAR(sine_part(error, 2), 0.005 * std::cos(0.8), 1e-9);
  EXPECT_NEAR(cosine_part(error, 2), -0.005 * std::sin(0.8), 1e-9);
  EXPECT_NEAR(sine_part(error, 1), 0.0, 1e-12);

  // The same from the field of a dipole in space, r = (s cos beta, s sin beta, -z).
  const double k = 2 * field.off_axis / (3 * (1 + field.off_axis));
  const double z = 2.0;
  const double s = z * std::sqrt(k / (1 - k));
  EXPECT_NEAR(1.5 * (s / z) * (s / z), field.off_axis, 0.02 * field.off_axis);
  const std::array<double, 3> r = {s * std::cos(0.4), s * std::sin(0.4), -z};
  const double length = std::hypot(r[0], r[1], r[2]);
  for (double alpha = 0; alpha < 6; alpha += 0.3) {
    const double along = std::cos(alpha) * r[0] + std::sin(alpha) * r[1];
    // On the axis the dipole's field in the plane is -m/z^3: the sensor sees it reversed.
    const double bx = std::cos(alpha) - 3 * along * r[0] / (length * length);
    const double by = std::sin(alpha) - 3 * along * r[1] / (length * length);
    EXPECT_NEAR(std::remainder(std::atan2(by, bx) - field.at(alpha).direction, kTurn), 0.0, 1e-12);
    EXPECT_NEAR(std::hypot(bx, by) * std::pow(z / length, 3), field.at(alpha).strength, 1e-12);
  }
}

TEST(Field, DirectionErrorAndSlip) {
  Field field;
  field.direction_errors.push_back({5, 0.002, 0.3});
  EXPECT_NEAR(field.at(1.1).direction - 1.1, 0.002 * std::sin(5 * 1.1 + 0.3), 1e-14);
  field.slip_time = 2.0;
  field.slip_step = 0.1;
  EXPECT_EQ(field.magnet_angle(1.0, 1.99), 1.0);
  EXPECT_EQ(field.magnet_angle(1.0, 2.01), 1.1);
}

TEST(Field, AngleIsNotWrapped) {
  Field field;
  field.stray = 0.01;
  EXPECT_NEAR(field.at(1000.0).direction, 1000.0, 0.011);
  EXPECT_NEAR(field.at(-1000.0).direction, -1000.0, 0.011);
}

TEST(Bridge, TorqueBalanceHolds) {
  for (double phi = 0; phi < 6.3; phi += 0.21)
    for (double h : {0.05, 0.25, 0.5}) {
      const double theta = stripe_magnetisation(phi, 0.3, h);
      EXPECT_NEAR(std::sin(phi - theta), h / 2 * std::sin(2 * (theta - 0.3)), 1e-14);
    }
}

TEST(Bridge, StripesGiveTheThirdHarmonicOfTheCatalogue) {
  for (double h : {0.05, 0.1, 0.2, 0.25}) {
    Bridge bridge;
    bridge.anisotropy = h;
    const double q = 3 * h * h / 8;
    const double next = std::pow(h, 4);
    const auto s = [&](double psi) { return bridge.signal(Channel::sine, psi / 2, 1.0); };
    const auto c = [&](double psi) { return bridge.signal(Channel::cosine, psi / 2, 1.0); };
    EXPECT_NEAR(sine_part(s, 3), -q, next) << h;
    EXPECT_NEAR(cosine_part(c, 3), q, next) << h;
    EXPECT_NEAR(sine_part(s, 1), 1 - q, next) << h;
    EXPECT_NEAR(cosine_part(c, 1), 1 - q, next) << h;
    EXPECT_NEAR(std::abs(coefficient([&](double x) { return Complex(s(x)); }, 2)), 0.0, 1e-12);
    // Angle error -(q/2) sin 8 alpha, alpha = psi/2.
    const auto error = [&](double psi) {
      return std::remainder(std::atan2(s(psi), c(psi)) - psi, kTurn) / 2;
    };
    EXPECT_NEAR(sine_part(error, 4), -q / 2, next) << h;
  }
}

TEST(Bridge, QuadratureTurnsTheBridgesApart) {
  for (int periods : {1, 2})
    for (double h : {0.0, 1e-6}) {
      Bridge bridge;
      bridge.periods_per_turn = periods;
      bridge.anisotropy = h;
      bridge.quadrature = 0.01;
      for (double phi = 0; phi < 6.3; phi += 0.37) {
        EXPECT_NEAR(bridge.signal(Channel::sine, phi, 1), std::sin(periods * phi + 0.005), 1e-9);
        EXPECT_NEAR(bridge.signal(Channel::cosine, phi, 1), std::cos(periods * phi - 0.005), 1e-9);
      }
    }
}

TEST(Bridge, PlayTrailsByHalfTheWidth) {
  Play play(0.02, 0.0, 1.0);
  EXPECT_NEAR(play(1.0), 0.99, 1e-15);
  EXPECT_NEAR(play(0.985), 0.99, 1e-15);
  EXPECT_NEAR(play(0.5), 0.51, 1e-15);
}

TEST(Thermal, LagTrailsARampByTau) {
  Lag lag(3.0, 0.0);
  double output = 0.0;
  for (int i = 1; i <= 4000; ++i)
    output = lag(0.01, 0.5 * 0.01 * i);
  EXPECT_NEAR(output, 0.5 * (40.0 - 3.0), 1e-4);
  EXPECT_EQ(lag(0.0, 20.0), output);
}

TEST(Chain, MismatchKeepsTheMean) {
  Bench bench = silent(600);
  bench.chain.mismatch = 0.01;
  const Capture capture = simulate(bench);
  const double sine = std::abs(fundamental(capture.vsin, capture, 2));
  const double cosine = std::abs(fundamental(capture.vcos, capture, 2));
  EXPECT_NEAR((sine + cosine) / 2, bench.chain.amplitude, 1e-9);
  EXPECT_NEAR((sine - cosine) / bench.chain.amplitude, 0.01, 1e-9);
}

TEST(Chain, TransferErrorsGiveTheirHarmonics) {
  Chain chain;
  chain.quadratic = 0.01;
  const auto bow = [&](double x) {
    return (chain.output(Channel::cosine, std::cos(x), x, 0, 0, 1, 0, 1) - 2.5) / chain.amplitude;
  };
  EXPECT_NEAR(cosine_part(bow, 2), 0.005, 1e-12);
  EXPECT_NEAR(cosine_part(bow, 0) / 2, 0.005, 1e-12);
  chain.quadratic = 0.0;
  chain.cubic = 0.01;
  const auto third = [&](double x) {
    return (chain.output(Channel::sine, std::sin(x), x, 0, 0, 1, 0, 1) - 2.5) / chain.amplitude;
  };
  EXPECT_NEAR(sine_part(third, 3), -0.0025, 1e-12);
  EXPECT_NEAR(sine_part(third, 1), 1.0075, 1e-12);
}

TEST(Chain, OffsetsFollowTheBridgeTemperature) {
  Chain chain;
  chain.vtemp_centre = 1.5;
  chain.sine = {0.01, 0.02, 0.03, 0.0};
  EXPECT_NEAR(chain.output(Channel::sine, 0, 0, 1.9, 0, 1, 0, 1) - 2.5,
              0.01 + 0.02 * 0.4 + 0.03 * 0.16, 1e-12);
  chain.amplitude_drift = -0.1;
  EXPECT_NEAR(chain.output(Channel::cosine, 1, 0, 1.9, 0, 1, 0, 1) - 2.5,
              chain.amplitude * (1 - 0.04), 1e-12);
}

TEST(Chain, ClipsAtTheLevel) {
  Bench bench = silent(600);
  bench.chain.clip_sine.high = 3.8;
  bench.chain.clip_cosine.low = 1.2;
  const Capture capture = simulate(bench);
  EXPECT_NEAR(*std::max_element(capture.vsin.begin(), capture.vsin.end()), 3.8, 1e-9);
  EXPECT_NEAR(*std::min_element(capture.vsin.begin(), capture.vsin.end()), 1.05, 1e-3);
  EXPECT_NEAR(*std::min_element(capture.vcos.begin(), capture.vcos.end()), 1.2, 1e-9);
}

TEST(Chain, LowPassIsTheAnalyticTransfer) {
  for (double rpm : {600.0, 3000.0, -3000.0}) {
    Bench bench = silent(rpm);
    bench.chain.low_pass_corner = 500.0;
    const Capture capture = simulate(bench);
    const double f = 2 * rpm / 60.0; // electrical, signed
    const Complex transfer = 1.0 / Complex(1.0, f / 500.0);
    // c = cos(psi): the coefficient of exp(j psi) is the transfer at f itself.
    const Complex c = fundamental(capture.vcos, capture, 2) / bench.chain.amplitude;
    const Complex s = fundamental(capture.vsin, capture, 2) / bench.chain.amplitude * Complex(0, 1);
    // The oversampled recursion joins its points by straight lines.
    EXPECT_NEAR(std::abs(c - transfer), 0.0, 2e-5) << rpm;
    EXPECT_NEAR(std::abs(s - transfer), 0.0, 2e-5) << rpm;
  }
}

TEST(Chain, DelayIsExactInTheAngle) {
  Bench bench = silent(1500);
  bench.delay = 40e-6;
  const Capture capture = simulate(bench);
  for (std::size_t i = 0; i < capture.time.size(); i += 97)
    EXPECT_NEAR(
        capture.vsin[i] - 2.5,
        bench.chain.amplitude * std::sin(2 * (capture.shaft[i] - 1500 * kRpm * bench.delay)), 1e-9);
}

TEST(Sampler, SkewTakesTheCosineLater) {
  for (double skew : {20e-6, -20e-6}) {
    Bench bench = silent(1500);
    bench.sampler.skew = skew;
    const Capture capture = simulate(bench);
    for (std::size_t i = 0; i < capture.time.size(); i += 97) {
      EXPECT_NEAR(capture.vsin[i] - 2.5, bench.chain.amplitude * std::sin(2 * capture.shaft[i]),
                  1e-9);
      EXPECT_NEAR(capture.vcos[i] - 2.5,
                  bench.chain.amplitude * std::cos(2 * (capture.shaft[i] + 1500 * kRpm * skew)),
                  1e-9);
    }
  }
}

TEST(Sampler, MultiplexerKeepsAPartOfThePreviousConversion) {
  Bench bench = silent(600);
  const Capture clean = simulate(bench);
  bench.sampler.memory = 0.01;
  const Capture capture = simulate(bench);
  for (std::size_t i = 1; i < capture.time.size(); i += 97) {
    EXPECT_NEAR(capture.vsin[i], 0.99 * clean.vsin[i] + 0.01 * capture.vtemp[i - 1], 1e-9);
    EXPECT_NEAR(capture.vcos[i], 0.99 * clean.vcos[i] + 0.01 * capture.vsin[i], 1e-9);
    EXPECT_NEAR(capture.vtemp[i], 0.99 * clean.vtemp[i] + 0.01 * capture.vcos[i], 1e-9);
  }
}

TEST(Converter, OutputsFollowTheSupply) {
  Bench bench = silent(600);
  const Capture clean = simulate(bench);
  bench.supply.lines.push_back({0.01, 40.0, 0.3});
  const Capture capture = simulate(bench);
  for (std::size_t i = 0; i < capture.time.size(); i += 97) {
    EXPECT_NEAR(capture.vsin[i] / capture.vdd[i], clean.vsin[i] / 5.0, 1e-9);
    EXPECT_NEAR(capture.vtemp[i] / capture.vdd[i], clean.vtemp[i] / 5.0, 1e-9);
    EXPECT_NEAR(capture.vdd[i], 5 * (1 + 0.01 * std::sin(40 * capture.time[i] + 0.3)), 1e-9);
  }
}

TEST(Converter, NoiseIsWhatWasAskedForAndQuantisationRounds) {
  Bench bench = silent(600, 5000, 50000);
  const Capture clean = simulate(bench);
  bench.converter.bits = 16;
  bench.converter.noise = 0.5e-3;
  bench.converter.excess_noise = 1.2e-3;
  const Capture capture = simulate(bench);
  double power = 0.0;
  for (std::size_t i = 0; i < capture.time.size(); ++i) {
    power += std::pow(capture.vsin[i] - clean.vsin[i], 2) / static_cast<double>(bench.samples);
    const double code = capture.vsin[i] / 5 * 65536;
    ASSERT_NEAR(code, std::round(code), 1e-6);
  }
  EXPECT_NEAR(std::sqrt(power), 1.3e-3, 0.02e-3);
}

TEST(Converter, StuckChannelStaysWhereItWas) {
  Bench bench = silent(600);
  bench.converter.stuck = {true, true, 0.5, StuckAt::last_value};
  const Capture capture = simulate(bench);
  EXPECT_NEAR(capture.vsin.back(), capture.vsin[2499], 1e-9);
  EXPECT_NE(capture.vsin[2498], capture.vsin[2499]);
}

TEST(Record, LossRemovesExactlyItsRowsAndHidesThem) {
  Bench bench = silent(600);
  const Capture clean = simulate(bench);
  bench.record.losses = {{1000, 7}, {3000, 1}};
  const Capture capture = simulate(bench);
  ASSERT_EQ(capture.time.size(), clean.time.size() - 8);
  EXPECT_EQ(capture.shaft[999], clean.shaft[999]);
  EXPECT_EQ(capture.shaft[1000], clean.shaft[1007]);
  EXPECT_EQ(capture.shaft[2992], clean.shaft[2999]);
  EXPECT_EQ(capture.shaft[2993], clean.shaft[3001]);
  for (std::size_t i = 0; i < capture.time.size(); ++i)
    ASSERT_NEAR(capture.time[i], static_cast<double>(i) / 5000.0, 1e-12);
}

TEST(Record, EccentricReference) {
  Bench bench = silent(600);
  bench.record.reference_zero = 0.3;
  bench.record.reference_eccentricity = 0.01;
  bench.record.reference_phase = 1.0;
  const Capture capture = simulate(bench);
  for (std::size_t i = 0; i < capture.time.size(); i += 97)
    EXPECT_NEAR(std::remainder(capture.reference[i] * kDegree - capture.shaft[i] - 0.3 -
                                   0.01 * std::sin(capture.shaft[i] + 1.0),
                               kTurn),
                0.0, 1e-9);
}

TEST(Record, WiringMistakes) {
  Bench bench = silent(600);
  const Capture clean = simulate(bench);
  bench.record.swapped = true;
  EXPECT_EQ(simulate(bench).vsin, clean.vcos);
  bench.record.swapped = false;
  bench.record.inverted_sine = true;
  EXPECT_NEAR(simulate(bench).vsin[321], 5.0 - clean.vsin[321], 1e-12);
}

TEST(Record, TextHasTheContractsForm) {
  Bench bench = silent(600, 5000, 3);
  bench.record.has_vdd = true;
  std::ostringstream out;
  write_text(out, bench, simulate(bench));
  EXPECT_EQ(out.str().find("# ada4571-capture/1\n# supply_v = 5.0\n# periods_per_turn = 2\n"), 0U);
  EXPECT_NE(out.str().find("\ntime_s,vsin_v,vcos_v,vtemp_v,vdd_v,reference_deg\n0.000000,2.500000,"
                           "3.950000,"),
            std::string::npos);
}

std::string text_of(std::uint64_t seed, const std::string &category) {
  std::ostringstream out;
  Scenario scenario = random_scenario(seed, {category, ""});
  write_text(out, scenario.bench, simulate(scenario.bench));
  write_json(out, scenario.expectation, category, scenario.description, seed);
  return out.str();
}

TEST(Scenario, FollowsFromItsSeed) {
  for (const char *category : {"three", "unknown"}) {
    EXPECT_EQ(text_of(5, category), text_of(5, category));
    EXPECT_NE(text_of(5, category), text_of(6, category));
  }
}

class EveryCategory : public testing::TestWithParam<std::string> {};

TEST_P(EveryCategory, GivesSoundCaptures) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Scenario scenario = random_scenario(seed, {GetParam(), ""});
    const Bench &bench = scenario.bench;
    for (const Bench &each : {bench, second_capture(scenario)}) {
      const Capture capture = simulate(each);
      std::size_t lost = 0;
      for (const LossEvent &loss : each.record.losses)
        lost += loss.count;
      EXPECT_EQ(capture.time.size() + lost, each.samples);
      for (std::size_t i = 0; i < capture.time.size(); ++i) {
        ASSERT_TRUE(capture.vsin[i] >= 0.0 && capture.vsin[i] <= 5.0) << scenario.description;
        ASSERT_TRUE(capture.vcos[i] >= 0.0 && capture.vcos[i] <= 5.0) << scenario.description;
        ASSERT_TRUE(capture.vtemp[i] >= 0.0 && capture.vtemp[i] <= 5.0) << scenario.description;
        ASSERT_TRUE(capture.reference[i] >= 0.0 && capture.reference[i] <= 360.0);
        const double speed = std::abs(each.motion.speed(capture.time[i]));
        ASSERT_LT(speed * each.bridge.periods_per_turn / each.sampler.rate, kTurn / 19)
            << scenario.description;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenario, EveryCategory, testing::ValuesIn(categories()));

TEST(Scenario, EveryCauseCanBeHiddenAlone) {
  for (const std::string &cause : causes())
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const Scenario scenario = random_scenario(seed, {"single", cause});
      ASSERT_EQ(scenario.expectation.effects.back().cause, cause);
      // A drift comes along where a lag or a curvature would not be seen without it.
      ASSERT_LE(scenario.expectation.effects.size(), 2U);
    }
}

TEST(Scenario, SecondCaptureKeepsTheSensorOnly) {
  const Scenario scenario = random_scenario(3, {"single", "stray-field"});
  const Bench second = second_capture(scenario);
  EXPECT_EQ(second.field.stray, scenario.bench.field.stray);
  EXPECT_EQ(second.chain.sine.offset, scenario.bench.chain.sine.offset);
  EXPECT_NE(second.motion.angle(1.0), scenario.bench.motion.angle(1.0));
  const Scenario lossy = random_scenario(3, {"single", "sample-loss"});
  EXPECT_TRUE(second_capture(lossy).record.losses.empty());
}

TEST(Scenario, RefusesWhatDoesNotExist) {
  EXPECT_THROW(random_scenario(1, {"nonsense", ""}), std::invalid_argument);
  EXPECT_THROW(random_scenario(1, {"single", "nonsense"}), std::invalid_argument);
  EXPECT_THROW(random_scenario(1, {"unknown", "nonsense"}), std::invalid_argument);
}

} // namespace
} // namespace truth
