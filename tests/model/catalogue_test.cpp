// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the effects say about themselves fits together.

#include <cmath>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "model/effect.h"
#include "model/effect_text.h"
#include "model/residual.h"
#include "support/seed.h"

namespace ada::test {
namespace {

TEST(Catalogue, RivalsExistAndStandOnce) {
  for (const Effect *effect : catalogue()) {
    const EffectInfo &info = effect->info();
    std::set<std::string_view> rivals;
    for (const Separation &s : info.separations) {
      EXPECT_NE(find_effect(s.rival), nullptr) << info.id << ": " << s.rival;
      EXPECT_NE(s.rival, info.id);
      EXPECT_TRUE(rivals.insert(s.rival).second) << info.id << ": " << s.rival;
      EXPECT_FALSE(s.experiment.empty());
    }
    if (!info.yields_to.empty()) {
      EXPECT_NE(find_effect(info.yields_to), nullptr) << info.id;
    }
  }
}

TEST(Catalogue, PriorAndCharacterFollowFromWhatAnEffectIs) {
  const std::set<std::string_view> axes = {"angle", "speed",     "temperature", "supply",
                                           "time",  "frequency", "noise"};
  for (const Effect *effect : catalogue()) {
    const EffectInfo &info = effect->info();
    EXPECT_EQ(info.prior_rank >= 3, info.signature) << info.id;
    EXPECT_GE(info.prior_rank, 0) << info.id;
    EXPECT_LE(info.prior_rank, 4) << info.id;
    EXPECT_EQ(info.character == Character::recorded, info.recorded) << info.id;
    EXPECT_TRUE(axes.contains(info.axis)) << info.id << ": " << info.axis;
    if (info.evidence == Evidence::process || info.evidence == Evidence::noise) {
      EXPECT_FALSE(info.correctable) << info.id; // nothing in a file takes it out
      EXPECT_NE(info.pattern, Pattern::other) << info.id;
    }
    if (info.id.starts_with("reference-")) {
      EXPECT_FALSE(info.correctable) << info.id;
      EXPECT_EQ(info.stage, Stage::record) << info.id;
    }
    if (info.repeats) { // something must tell one from the other
      bool place = false;
      for (const ParameterInfo &p : info.parameters)
        place |= p.role == Role::chosen || p.name == "frequency_hz";
      EXPECT_TRUE(place) << info.id;
    }
  }
}

TEST(Catalogue, PhysicalOrderIsTheStagesOrderForWhatTheForwardModelRuns) {
  Model model;
  for (const char *id : {"reference-harmonic", "clipping", "reference-delay", "stray-field"})
    model.effects.push_back(parse_effect(id));
  const auto ordered = in_physical_order(model.effects);
  EXPECT_EQ(ordered[0].effect, find_effect("stray-field"));
  EXPECT_EQ(ordered[1].effect, find_effect("clipping"));
  EXPECT_EQ(ordered[2].effect, find_effect("reference-delay"));
  EXPECT_EQ(ordered[3].effect, find_effect("reference-harmonic"));
}

/// A residual that is a turn of the pair alone.
struct Turning {
  std::vector<float> omega;
  std::vector<double> time, sin_v, cos_v, model_sin_v, model_cos_v, alpha;
  Residual residual;
  Turning(double turns, std::size_t n, double noise_rad, const std::vector<double> &orders,
          double size_rad) {
    std::mt19937_64 rng(fresh_seed());
    std::normal_distribution<double> normal;
    for (std::size_t i = 0; i < n; ++i) {
      const double a = kTwoPi * turns * static_cast<double>(i) / static_cast<double>(n);
      double error = noise_rad * normal(rng);
      for (const double order : orders)
        error += size_rad * std::sin(order * a + 1.0);
      time.push_back(static_cast<double>(i) * 1e-3);
      omega.push_back(static_cast<float>(kTwoPi * turns / static_cast<double>(n) * 1e3));
      alpha.push_back(a);
      model_sin_v.push_back(2.5 + 1.4 * std::sin(2 * a));
      model_cos_v.push_back(2.5 + 1.4 * std::cos(2 * a));
      sin_v.push_back(1.4 * 2 * error * std::cos(2 * a));
      cos_v.push_back(-1.4 * 2 * error * std::sin(2 * a));
    }
    residual.periods = 2;
    residual.supply_v = 5.0;
    residual.has_reference = true;
    residual.sample_period_s = 1e-3;
    residual.time = time;
    residual.omega = omega;
    residual.sin_v = sin_v;
    residual.cos_v = cos_v;
    residual.model_sin_v = model_sin_v;
    residual.model_cos_v = model_cos_v;
    residual.alpha = alpha;
  }
};

TEST(FindOrders, FindsWholeAndBrokenOrders) {
  const Turning t(50.3, 30000, 1e-3, {20.0, 7.3}, 5e-4);
  const auto orders = find_orders(t.residual);
  ASSERT_GE(orders.size(), 2u);
  for (const double wanted : {20.0, 7.3}) {
    double least = 1e9;
    for (const double o : orders)
      least = std::min(least, std::abs(o - wanted));
    // The Cramer-Rao bound of half the noise in 30000 samples is 0.009 lines of 1/50.3.
    EXPECT_LT(least, 0.1 / 50.3) << wanted;
  }
}

TEST(FindOrders, FindsWholeOrdersWhereNoTurnFollowsAnother) {
  const Turning t(1.8, 3000, 1e-3, {20.0}, 1e-3);
  const auto orders = find_orders(t.residual);
  ASSERT_FALSE(orders.empty());
  EXPECT_EQ(orders.front(), 20.0);
}

TEST(FindOrders, FindsOneInAPartOfATurnThatItComesOftenIn) {
  const std::vector<double> seen = find_orders(Turning(0.8, 3000, 1e-3, {20.0}, 1e-2).residual);
  ASSERT_FALSE(seen.empty());
  EXPECT_NEAR(seen.front(), 20.0, 1.0 / 0.8); // as far as so short a way tells
}

TEST(FindOrders, IsQuietWhereNothingComesOftenOrThereAreNoLines) {
  // Of the noise one line in 4096 passes: far off, and once in six draws.
  const Turning seldom(0.8, 3000, 1e-3, {5.0}, 1e-2);
  for (const double order : find_orders(seldom.residual))
    EXPECT_GT(order * 0.8, kFewestPeriodsOfOrder);
  EXPECT_TRUE(find_orders(Turning(10.0, 3000, 0.0, {}, 0.0).residual).empty());
}

/// A shaft that moves as told (degrees), its pair with noise, and a reference of one's own.
struct Stepped {
  Capture capture;
  Screened look;
  template <class Angle, class Read>
  Stepped(std::size_t n, double noise_deg, Angle angle, Read read)
      : look{capture} {
    std::mt19937_64 rng(fresh_seed());
    std::normal_distribution<double> normal(0.0, noise_deg);
    for (std::size_t i = 0; i < n; ++i) {
      const double a = angle(static_cast<double>(i));
      capture.time_s.push_back(1e-3 * static_cast<double>(i));
      look.angle.push_back((a + normal(rng)) * kRadPerDeg);
      capture.reference_deg.push_back(wrap(read(a), 360.0));
    }
    look.usable.assign(n, 1);
  }
};

double nearest(double step, double a) {
  return step * std::round(a / step);
}

TEST(FindReferenceStep, MeasuresTheStepOfACounter) {
  for (const double step : {0.1, 0.36, 360.0 / 4096})
    for (const double speed : {0.0313, 1.777, -0.0313}) {
      const Stepped s(
          20000, 0.01, [&](double i) { return speed * i; },
          [&](double a) { // as a text of four decimals has it
            return 1e-4 * std::round(1e4 * nearest(step, wrap(a, 360.0)));
          });
      EXPECT_NEAR(find_reference_step(s.look), step, 1e-6 * 360) << step << ' ' << speed;
    }
}

TEST(FindReferenceStep, IsNotMisledByPlacesThatLieOnAGrid) {
  // Stops of an indexing table: at rest on whole multiples of five degrees.
  const Stepped stops(
      1000, 0.01, [](double i) { return 5.0 * std::floor(i / 40.0); }, [](double a) { return a; });
  EXPECT_EQ(find_reference_step(stops.look), 0.0);
  // A thousand even places over a turn, read exactly.
  const Stepped places(
      5000, 0.01, [](double i) { return 0.36 * i; }, [](double a) { return a; });
  EXPECT_EQ(find_reference_step(places.look), 0.0);
  // The rounding of the text is far below the noise.
  const Stepped text(
      5000, 0.01, [](double i) { return 0.0313 * i; }, [](double a) { return nearest(1e-3, a); });
  EXPECT_EQ(find_reference_step(text.look), 0.0);
}

} // namespace
} // namespace ada::test
