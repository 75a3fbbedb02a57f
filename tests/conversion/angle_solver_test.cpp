// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "conversion/angle_solver.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "model/effect_text.h"
#include "model/forward.h"
#include "support/remainder.h"
#include "support/seed.h"

namespace ada::test {
namespace {

constexpr std::size_t kSamples = 8000;
constexpr double kPeriodS = 1e-4;

Model sensor() {
  Model model;
  model.supply_v = 5.0;
  model.periods_per_turn = 2;
  model.baseline = {1.45, 0.004, -0.003, 1.0};
  return model;
}

Model sensor_with(const char *effect) {
  Model model = sensor();
  model.effects.push_back(parse_effect(effect));
  return model;
}

/// A steady shaft at one temperature, without noise; `alpha` takes its angle, rad.
Capture steady(const Model &model, double mid_shift_v, double start, std::vector<double> &alpha) {
  constexpr double kOmega = 30.0;
  Capture c;
  c.meta.supply_v = model.supply_v;
  c.meta.periods_per_turn = model.periods_per_turn;
  const std::vector<float> omega(kSamples, static_cast<float>(kOmega)), temp(kSamples, 1.5f),
      rate(kSamples, 0.0f);
  const std::vector<signed char> direction(kSamples, 1);
  for (std::size_t i = 0; i < kSamples; ++i) {
    c.time_s.push_back(static_cast<double>(i) * kPeriodS);
    alpha.push_back(start + kOmega * c.time_s.back());
  }
  c.vsin_v.resize(kSamples);
  c.vcos_v.resize(kSamples);
  c.vtemp_v.assign(kSamples, 1.5);
  const Conditions at{.n = kSamples,
                      .time = c.time_s.data(),
                      .alpha = alpha.data(),
                      .omega = omega.data(),
                      .direction = direction.data(),
                      .temp = temp.data(),
                      .temp_rate = rate.data(),
                      .frame_period_s = kPeriodS,
                      .mid_shift_v = mid_shift_v};
  ForwardModel(model, AlphaIs::reference).evaluate(at, c.vsin_v.data(), c.vcos_v.data());
  return c;
}

double worst_error_deg(const std::vector<double> &alpha, const std::vector<ada4571_angle> &out,
                       int periods) {
  double worst = 0.0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double error = out[i].angle_deg - alpha[i] * kDegPerRad;
    worst = std::max(worst, std::abs(wrap_centred(error, 360.0 / periods)));
  }
  return worst;
}

class AngleSolverTest : public testing::Test {
protected:
  std::mt19937_64 rng_{fresh_seed()};
  double start_ = std::uniform_real_distribution<>(0.0, kTwoPi)(rng_);
};

TEST_F(AngleSolverTest, KnowsMidSupplyFromTheRecordedSupplyLiveAsInACapture) {
  const Model model = sensor_with("quadratic-nonlinearity:q2=0.02");
  std::vector<double> alpha;
  Capture c = steady(model, 0.1, start_, alpha);
  c.vdd_v.assign(kSamples, 5.2);
  std::vector<ada4571_angle> out(kSamples);
  AngleSolver(model).capture(c, out);
  EXPECT_LT(worst_error_deg(alpha, out, 2), 1e-4);

  AngleSolver live(model);
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < kSamples; ++i)
    frames.push_back(c.frame(i));
  live.frames(frames, out);
  EXPECT_LT(worst_error_deg(alpha, out, 2), 1e-4);

  c.vdd_v.clear(); // the test can fail: without VDD the bend lies elsewhere
  AngleSolver(model).capture(c, out);
  EXPECT_GT(worst_error_deg(alpha, out, 2), 1e-3);
}

TEST_F(AngleSolverTest, ASupplyThatMovesVtempIsNoTemperature) {
  const Model model = sensor_with("offset-temperature-drift:tc_sin=0.2,tc_cos=-0.1");
  std::vector<double> alpha;
  Capture c = steady(model, 0.0, start_, alpha);
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double moved = 1.0 + 0.01 * std::sin(3.0 * kTwoPi * static_cast<double>(i) / kSamples);
    c.vdd_v.push_back(5.0 * moved);
    c.vtemp_v[i] *= moved;
  }
  std::vector<ada4571_angle> out(kSamples);
  AngleSolver(model).capture(c, out);
  EXPECT_LT(worst_error_deg(alpha, out, 2), 1e-3);

  c.vdd_v.clear(); // the test can fail: without VDD it passes for a temperature
  AngleSolver(model).capture(c, out);
  EXPECT_GT(worst_error_deg(alpha, out, 2), 1e-3);
}

class AngleSolverRemainder : public AngleSolverTest {
protected:
  /// The worst error of angles from `out`, which solves a capture of the model, and from a stream.
  void expect_solved(const Model &model) {
    std::vector<double> alpha;
    Capture c = steady(model, 0.0, start_, alpha);
    for (double a : alpha) // for the part of a turn
      c.reference_deg.push_back(a * kDegPerRad);
    std::vector<ada4571_angle> out(kSamples);
    AngleSolver(model).capture(c, out);
    EXPECT_LT(worst_error_deg(alpha, out, model.periods_per_turn), 1e-6);
    for (const ada4571_angle &angle : out)
      ASSERT_NEAR(angle.radius, 1.0, 1e-6);
    std::vector<Frame> frames;
    for (std::size_t i = 0; i < kSamples; ++i)
      frames.push_back(c.frame(i));
    AngleSolver live(model);
    live.frames(frames, out);
    EXPECT_LT(worst_error_deg(alpha, out, model.periods_per_turn), 1e-6);
  }
};

TEST_F(AngleSolverRemainder, IsTakenOutWhateverItsSizeAndOrders) {
  for (const int periods : {1, 2})
    for (const bool electrical : {false, true})
      for (const double first : {0.001, 0.01, 0.05})
        for (const std::size_t orders : {std::size_t{3}, std::size_t{64}}) {
          SCOPED_TRACE(testing::Message() << "p " << periods << " electrical " << electrical
                                          << " first " << first << " orders " << orders);
          Model model = sensor();
          model.periods_per_turn = periods;
          model.remainder = drawn_remainder(rng_, orders, first, electrical);
          expect_solved(model);
        }
}

TEST_F(AngleSolverRemainder, IsTakenOutBesideEffectsAndWrongWiring) {
  Model model = sensor_with("channel-swap");
  for (const char *effect : {"channel-inverted:channel=vcos", "stray-field:b=0.01",
                             "quadrature-error:delta_deg=2", "weak-field:q=0.01"})
    model.effects.push_back(parse_effect(effect));
  model.remainder = drawn_remainder(rng_, 64, 0.02, false);
  expect_solved(model);
}

/// A magnetometer beside iron: the circle does not enclose mid-supply.
TEST_F(AngleSolverRemainder, IsTakenOutAboutACentreThatIsRecordedByWrongWiring) {
  const std::vector<std::vector<const char *>> wirings{
      {"channel-swap"},
      {"channel-inverted:channel=vcos"},
      {"channel-inverted:channel=vcos", "channel-swap"}}; // whatever the order in the file
  for (const auto &wires : wirings) {
    Model model = sensor();
    for (const char *effect : wires)
      model.effects.push_back(parse_effect(effect));
    model.baseline = {0.35, -0.07, -1.12, 1.0};
    model.remainder = drawn_remainder(rng_, 4, 0.02, false);
    expect_solved(model);
  }
}

TEST_F(AngleSolverRemainder, WithoutItTheAngleErrs) { // the tests above can fail
  Model model = sensor();
  model.remainder = drawn_remainder(rng_, 64, 0.01, false);
  std::vector<double> alpha;
  const Capture c = steady(model, 0.0, start_, alpha);
  std::vector<ada4571_angle> out(kSamples);
  model.remainder.reset();
  AngleSolver(model).capture(c, out);
  EXPECT_GT(worst_error_deg(alpha, out, 2), 0.05); // order 1: about 0.01 rad / p = 0.29 deg
}

TEST_F(AngleSolverRemainder, SaysWhichPartOfATurnWithoutAReference) {
  // As with a stray field: of the parts of a turn that the pair cannot tell apart, the one in
  // which the shaft turns evenly.
  Model model = sensor();
  model.remainder = drawn_remainder(rng_, 5, 0.02, false);
  std::vector<double> alpha;
  const Capture c = steady(model, 0.0, start_, alpha);
  std::vector<ada4571_angle> out(kSamples);
  AngleSolver(model).capture(c, out);
  EXPECT_LT(worst_error_deg(alpha, out, 2), 1e-6);
}

TEST_F(AngleSolverRemainder, AReversalDoesNotHideThePartOfATurn) {
  Model model = sensor();
  model.remainder = drawn_remainder(rng_, 5, 0.02, false);
  std::vector<double> alpha;
  Capture c = steady(model, 0.0, start_, alpha);
  // The way there and back again: the second half is the first one, read from its end.
  const std::size_t half = c.size() / 2;
  for (std::size_t i = half; i < c.size(); ++i) {
    const std::size_t from = 2 * half - 1 - std::min(i, 2 * half - 1);
    alpha[i] = alpha[from];
    c.vsin_v[i] = c.vsin_v[from];
    c.vcos_v[i] = c.vcos_v[from];
  }
  std::vector<ada4571_angle> out(kSamples);
  AngleSolver(model).capture(c, out);
  EXPECT_LT(worst_error_deg(alpha, out, 2), 1e-6);
}

} // namespace
} // namespace ada::test
