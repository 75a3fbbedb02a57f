// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <cmath>

#include <gtest/gtest.h>

#include "base/error.h"
#include "model/effect.h"
#include "model/effect_text.h"
#include "model/model.h"

namespace ada::test {
namespace {

TEST(AtSupply, ScalesVoltsAndKeepsRatios) {
  Model m;
  m.supply_v = 5;
  m.baseline = {1.45, 0.02, -0.01, 12};
  m.baseline_std_error = {1e-3, 2e-3, 3e-3, 0.5};
  m.vtemp_reference_v = 1.5;
  m.noise_rms_v = 1e-3;
  m.provenance.vtemp_min_v = 1.0;
  add_effect(m, parse_effect("amplitude-mismatch:k=0.01"));
  add_effect(m, parse_effect("offset-temperature-drift:tc_sin=0.02,tc_cos=0.03"));
  add_effect(m, parse_effect("offset-temperature-curvature:c_sin=0.02,c_cos=0.03"));
  add_effect(m, parse_effect("amplitude-temperature-drift:tc_amplitude=-0.1"));
  add_effect(m, parse_effect("clipping:low_v=none,high_v=4"));
  m.effects[1].std_errors = {0.1, 0.1};
  m.effects[2].std_errors = {0.1, std::nan("")};

  const Model half = m.at_supply(2.5);
  EXPECT_EQ(half.supply_v, 2.5);
  EXPECT_EQ(half.baseline.amplitude_v, 0.725);
  EXPECT_EQ(half.baseline.offset_sin_v, 0.01);
  EXPECT_EQ(half.baseline.offset_cos_v, -0.005);
  EXPECT_EQ(half.baseline.angle_zero_deg, 12);
  EXPECT_EQ(half.baseline_std_error.offset_cos_v, 1.5e-3);
  EXPECT_EQ(half.baseline_std_error.angle_zero_deg, 0.5);
  EXPECT_EQ(half.vtemp_reference_v, 0.75);
  EXPECT_EQ(half.noise_rms_v, 0.5e-3);
  EXPECT_EQ(half.provenance.vtemp_min_v, 0.5);
  EXPECT_EQ(half.effects[0].values[0], 0.01); // a ratio
  EXPECT_EQ(half.effects[1].values[0], 0.02); // volts a volt of VTEMP
  EXPECT_EQ(half.effects[1].std_errors[0], 0.1);
  EXPECT_EQ(half.effects[2].values[0], 0.04); // volts a squared volt
  EXPECT_EQ(half.effects[2].std_errors[0], 0.2);
  EXPECT_TRUE(std::isnan(half.effects[2].std_errors[1]));
  EXPECT_EQ(half.effects[3].values[0], -0.2);         // a volt of VTEMP is twice the temperature
  EXPECT_TRUE(std::isnan(half.effects[4].values[0])); // absent stays absent
  EXPECT_EQ(half.effects[4].values[1], 2);
}

TEST(AtSupply, RefusesNoSupply) {
  for (const double volts : {0.0, -5.0, std::nan(""), static_cast<double>(INFINITY)})
    EXPECT_THROW(Model().at_supply(volts), Error);
}

} // namespace
} // namespace ada::test
