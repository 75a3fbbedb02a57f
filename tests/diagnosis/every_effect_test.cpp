// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Every effect of the catalogue once through the whole diagnosis, with and without a reference:
// whatever an effect leaves out (parameters, a guess, a rival) must not trip the engine. Whether
// the answer is right is a matter of hidden_effects.

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "diagnosis/diagnose.h"
#include "model/effect.h"
#include "simulation/simulation.h"
#include "support/seed.h"

namespace ada::test {
namespace {

class EveryEffect : public testing::TestWithParam<const Effect *> {};

TEST_P(EveryEffect, gets_an_answer) {
  const std::uint64_t seed = fresh_seed();
  const Effect &effect = *GetParam();
  SimulationOptions options;
  options.sample_rate_hz = 500.0;
  options.duration_s = 4.0;
  options.motion = "steps:rpm=120/400/-400/-120";
  options.temperature = "ramp:from=20,to=40";
  Model model = sound_sensor(seed, 5.0, true);
  std::vector<double> values;
  for (const ParameterInfo &p : effect.info().parameters)
    values.push_back(p.fallback);
  model.effects.push_back({&effect, values, {}});
  Capture capture = Simulation(model, options, seed).run();
  for (const bool reference : {true, false}) {
    if (!reference)
      capture.reference_deg.clear();
    const Diagnosis d = diagnose(capture, {});
    EXPECT_FALSE(to_json(d).empty());
    for (const Finding &f : d.findings) {
      ASSERT_EQ(f.values.size(), f.effect->info().parameters.size());
      for (const double v : f.values)
        EXPECT_FALSE(std::isinf(v)) << f.effect->info().id; // NaN: not present
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryEffect,
                         testing::ValuesIn(catalogue().begin(), catalogue().end()),
                         [](const auto &i) {
                           std::string name(i.param->info().id);
                           for (char &c : name)
                             c = c == '-' ? '_' : c;
                           return name;
                         });

} // namespace
} // namespace ada::test
