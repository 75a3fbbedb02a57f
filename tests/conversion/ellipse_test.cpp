// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "conversion/ellipse.h"

#include <cmath>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "base/error.h"
#include "calibration/single.h"
#include "model/effect.h"
#include "support/seed.h"
#include "support/sensor_pair.h"

namespace ada::test {
namespace {

TEST(Ellipse, inverse_undoes_the_ellipse_at_every_angle) {
  Sampler draw(SensorPair{}, fresh_seed());
  for (int i = 0; i < 200; ++i) {
    const EllipseParameters e{draw.uniform(0.1, 3), draw.uniform(-1, 1), draw.uniform(-1, 1),
                              draw.uniform(-1, 4), draw.uniform(-1, 4)};
    const EllipseInverse inverse = invert(e);
    const double psi = draw.uniform(-kPi, kPi);
    const double s =
        e.centre_sin_v + e.amplitude_v * (1 + e.k / 2) * std::sin(psi + e.delta_rad / 2);
    const double c =
        e.centre_cos_v + e.amplitude_v * (1 - e.k / 2) * std::cos(psi - e.delta_rad / 2);
    EXPECT_NEAR(inverse.sine(s, c), std::sin(psi), 1e-12);
    EXPECT_NEAR(inverse.cosine(s, c), std::cos(psi), 1e-12);
  }
}

TEST(Ellipse, without_an_inverse_is_refused) {
  EXPECT_THROW(invert({0.0, 0, 0, 0, 0}), Error);
  EXPECT_THROW(invert({1.0, 2.0, 0, 0, 0}), Error);
  EXPECT_THROW(invert({1.0, 0, kPi / 2, 0, 0}), Error);
  EXPECT_THROW(invert({std::nan(""), 0, 0, 0, 0}), Error);
}

/// A model with everything that folds in, and the test's own sensor with the same.
struct Folded {
  SensorPair pair;
  Model model;
};

Folded drawn(Sampler &draw) {
  Folded f;
  f.pair.noise_rms_v = 0;
  f.pair.adc_bits = 0;
  f.pair.k = draw.uniform(-0.1, 0.1);
  f.pair.delta_rad = draw.uniform(-0.1, 0.1);
  f.pair.tc_sin = draw.uniform(-0.02, 0.02);
  f.pair.tc_cos = draw.uniform(-0.02, 0.02);
  f.pair.tc_amplitude = draw.uniform(-0.2, 0.2);
  f.model.baseline = {f.pair.amplitude_v, f.pair.offset_sin_v, f.pair.offset_cos_v, 0};
  f.model.vtemp_reference_v = f.pair.vtemp_reference_v;
  f.model.effects = {
      effect_instance("amplitude-mismatch", {f.pair.k}, {}),
      effect_instance("quadrature-error", {f.pair.delta_rad * kDegPerRad}, {}),
      effect_instance("offset-temperature-drift", {f.pair.tc_sin, f.pair.tc_cos}, {}),
      effect_instance("amplitude-temperature-drift", {f.pair.tc_amplitude}, {})};
  return f;
}

TEST(EllipseModel, folds_temperature_and_wiring_in) {
  Sampler draw(SensorPair{}, fresh_seed());
  for (const char *wiring : {"", "channel-swap", "sin-inverted", "cos-inverted", "both"}) {
    Folded f = drawn(draw);
    const std::string w = wiring;
    const bool swapped = w == "channel-swap" || w == "both";
    const bool sin_inverted = w == "sin-inverted" || w == "both",
               cos_inverted = w == "cos-inverted";
    if (swapped)
      f.model.effects.push_back(effect_instance("channel-swap", {}, {}));
    if (sin_inverted || cos_inverted)
      f.model.effects.push_back(
          effect_instance("channel-inverted", {cos_inverted ? 1.0 : 0.0}, {}));
    const EllipseModel ellipse(f.model);
    EXPECT_TRUE(ellipse.follows_temperature());
    Sampler sensor(f.pair, 1);
    for (int i = 0; i < 50; ++i) {
      const double alpha = draw.uniform(0, kPi), vtemp = draw.uniform(1.0, 2.5);
      double s, c;
      sensor.pair_at(alpha, vtemp, s, c);
      if (swapped)
        std::swap(s, c);
      if (sin_inverted)
        s = f.pair.supply_v - s;
      if (cos_inverted)
        c = f.pair.supply_v - c;
      const EllipseInverse inverse = ellipse.at(vtemp);
      EXPECT_NEAR(inverse.sine(s, c), std::sin(2 * alpha), 1e-9) << w;
      EXPECT_NEAR(inverse.cosine(s, c), std::cos(2 * alpha), 1e-9) << w;
    }
  }
}

TEST(EllipseModel, names_what_goes_beyond_it_and_ignores_what_no_reader_corrects) {
  Model model;
  EXPECT_EQ(EllipseModel::beyond(model), "");
  model.effects.push_back({find_effect("impulse-noise"), {0.001, 0.5}, {}});
  EXPECT_EQ(EllipseModel::beyond(model), "");
  model.effects.push_back(effect_instance("weak-field", {0.01}, {}));
  EXPECT_EQ(EllipseModel::beyond(model), "weak-field");
  EXPECT_THROW(EllipseModel{model}, Error);
}

} // namespace
} // namespace ada::test
