// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A family of models gives the volts of each of them.

#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "model/effect.h"
#include "model/forward.h"
#include "support/seed.h"

namespace ada::test {
namespace {

struct Samples {
  std::vector<double> time, alpha;
  std::vector<float> omega, temp, scan, accel, supply, supply_rate, supply_bend, temp_rate, travel;
  std::vector<signed char> direction;
  Conditions at;
};

Samples random_samples(std::size_t n, std::mt19937_64 &rng) {
  std::normal_distribution<> normal;
  Samples out;
  for (std::size_t i = 0; i < n; ++i) {
    out.time.push_back(1e-4 * static_cast<double>(i));
    out.alpha.push_back(0.01 * static_cast<double>(i) + 0.1 * normal(rng));
    for (auto *column : {&out.omega, &out.temp, &out.scan, &out.accel, &out.supply,
                         &out.supply_rate, &out.supply_bend, &out.temp_rate, &out.travel})
      column->push_back(static_cast<float>(normal(rng)));
    out.direction.push_back(normal(rng) > 0.0 ? 1 : -1);
  }
  Conditions &at = out.at;
  at.n = n;
  at.time = out.time.data();
  at.alpha = out.alpha.data();
  at.omega = out.omega.data();
  at.accel = out.accel.data();
  at.direction = out.direction.data();
  at.travel = out.travel.data();
  at.temp = out.temp.data();
  at.temp_rate = out.temp_rate.data();
  at.supply = out.supply.data();
  at.supply_rate = out.supply_rate.data();
  at.supply_bend = out.supply_bend.data();
  at.vtemp_scan = out.scan.data();
  at.frame_period_s = 1e-4;
  return out;
}

EffectInstance at_defaults(const Effect &effect) {
  EffectInstance out{&effect, {}, {}};
  for (const ParameterInfo &p : effect.info().parameters)
    out.values.push_back(p.fallback);
  return out;
}

TEST(ForwardFamily, gives_the_volts_of_each_model_to_the_bit) {
  std::mt19937_64 rng(fresh_seed());
  const Samples samples = random_samples(200, rng);
  std::vector<const Effect *> of_signal;
  for (const Effect *effect : catalogue())
    if (effect->info().evidence == Evidence::signal)
      of_signal.push_back(effect);
  std::uniform_int_distribution<std::size_t> some(0, 5), any(0, of_signal.size() - 1);
  std::normal_distribution<> normal;
  for (int draw = 0; draw < 60; ++draw) {
    Model first;
    first.periods_per_turn = 1 + draw % 3;
    for (std::size_t k = some(rng); k-- > 0;)
      first.effects.push_back(at_defaults(*of_signal[any(rng)]));
    if (draw % 4 == 0)
      first.remainder =
          PeriodicRemainder{draw % 8 == 0, {0.01, 0.0}, {0.0, 0.002}, {0.003, 0.0}, {0.0, 0.0}};
    std::vector<Model> models{first};
    for (const Effect *effect : of_signal) { // one more
      models.push_back(first);
      models.back().effects.push_back(at_defaults(*effect));
    }
    for (std::size_t k = 0; k < first.effects.size(); ++k) { // one otherwise, and one less
      models.push_back(first);
      for (double &v : models.back().effects[k].values)
        v *= 1.0 + 0.1 * normal(rng);
      models.push_back(first.without(k));
    }
    for (double Baseline::*number : {&Baseline::amplitude_v, &Baseline::offset_sin_v,
                                     &Baseline::offset_cos_v, &Baseline::angle_zero_deg}) {
      models.push_back(first);
      models.back().baseline.*number += 0.01;
    }
    ForwardFamily family(first, AlphaIs::reference);
    for (std::size_t k = 1; k < models.size(); ++k)
      family.add(models[k]);
    std::size_t taken = 0;
    family.evaluate(samples.at, [&](std::size_t k, const double *sin, const double *cos) {
      ASSERT_EQ(k, taken++);
      std::vector<double> s(samples.at.n), c(samples.at.n);
      ForwardModel(models[k], AlphaIs::reference).evaluate(samples.at, s.data(), c.data());
      for (std::size_t i = 0; i < samples.at.n; ++i)
        ASSERT_TRUE((sin[i] == s[i] && cos[i] == c[i]) ||
                    (std::isnan(s[i]) && std::isnan(sin[i])) ||
                    (std::isnan(c[i]) && std::isnan(cos[i])))
            << "model " << k << " of draw " << draw << ", sample " << i;
    });
    EXPECT_EQ(taken, models.size());
  }
}

} // namespace
} // namespace ada::test
