// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Hostile numbers through diagnose, as far as the readers let them pass: it ends, with an answer or
// a reason, and every number of an answer is one.

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "base/error.h"
#include "calibration/single.h"
#include "diagnosis/diagnose.h"
#include "recording/columns.h"
#include "support/hostile_numbers.h"
#include "support/seed.h"

namespace ada::test {
namespace {

/// Far more than any search makes: one that makes as many goes on for ever.
constexpr int kMostSteps = 2000;

/// An answer, all of whose numbers are numbers, or a sentence.
void expect_an_end(const Capture &capture, const Model *baseline) {
  int steps = 0;
  DiagnosisOptions options;
  options.baseline = baseline;
  options.progress = [&steps](double fraction, const char *what) {
    EXPECT_TRUE(fraction >= 0 && fraction <= 1) << fraction;
    if (++steps > kMostSteps)
      throw std::logic_error(std::string("it does not end: ") + what);
  };
  try {
    const Diagnosis diagnosis = diagnose(capture, options);
    const std::string json = to_json(diagnosis), text = to_text(diagnosis);
    for (const char *word : {"nan", "inf "})
      EXPECT_EQ(text.find(word), std::string::npos) << text;
    EXPECT_EQ(json.find("nan"), std::string::npos);
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_UNUSABLE_DATA) << e.what();
    EXPECT_STRNE(e.what(), "");
  }
}

/// The nearest that a file may hold.
void keep_within_bounds(Capture &capture) {
  for (const Column &column : kColumns)
    for (double &value : capture.*column.values)
      if (!(std::fabs(value) <= column.limit))
        value = std::copysign(column.limit, value);
  std::sort(capture.time_s.begin(), capture.time_s.end());
}

class HostileDiagnosis : public testing::TestWithParam<Hostile> {};

TEST_P(HostileDiagnosis, comes_to_an_end) {
  std::mt19937_64 rng(fresh_seed());
  constexpr unsigned kBothChannels = 0b110, kReference = 1u << 5;
  std::vector<unsigned> masks{kBothChannels};
  for (unsigned column = 0; column < kHostileColumns.size(); ++column)
    masks.push_back(1u << column);
  masks.push_back(static_cast<unsigned>(rng() % 63 + 1));
  for (const unsigned columns : masks)
    for (const bool with_reference : {true, false}) {
      if (!with_reference && (columns & kReference))
        continue;
      SCOPED_TRACE("columns " + std::to_string(columns) +
                   (with_reference ? ", with" : ", without") + " a reference");
      Capture c = hostile_capture(GetParam(), columns, 500, rng);
      if (!with_reference)
        c.reference_deg.clear();
      keep_within_bounds(c);
      expect_an_end(c, nullptr);
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, HostileDiagnosis, testing::ValuesIn(kHostile),
                         [](const auto &kind) { return name_of(kind.param); });

TEST(HostileModel, whose_outputs_know_one_level_only_comes_to_an_end) {
  std::mt19937_64 rng(fresh_seed());
  const Capture sound = hostile_capture(Hostile::constant, 0, 1000, rng);
  const Effect *clipping = find_effect("clipping");
  ASSERT_NE(clipping, nullptr);
  for (const double level_v : {-1.0, 0.0, 1.5, 2.5, 5.0, 1e6}) {
    SCOPED_TRACE(level_v);
    Model model = calibrate_single(sound, CalibrationMethod::fit);
    // From low_v to high_v, on both channels.
    model.effects.push_back({clipping, {level_v, level_v, std::nan("")}, {}});
    expect_an_end(sound, &model);
  }
}

/// Every effect, all of its parameters at one end of what a file may hold, or all of one value.
TEST(HostileModel, with_an_effect_at_the_end_of_its_range_comes_to_an_end) {
  std::mt19937_64 rng(fresh_seed());
  const Capture sound = hostile_capture(Hostile::constant, 0, 300, rng);
  constexpr double kUnbounded = 1e9;
  for (const Effect *effect : catalogue())
    for (const double wanted : {-HUGE_VAL, HUGE_VAL, 0.0, 1.0, 5e-324}) {
      SCOPED_TRACE(std::string(effect_info(*effect).id) + " at " + std::to_string(wanted));
      Model model = calibrate_single(sound, CalibrationMethod::fit);
      std::vector<double> values;
      for (const ParameterInfo &p : effect_info(*effect).parameters)
        values.push_back(
            std::clamp(wanted, std::max(p.minimum, -kUnbounded), std::min(p.maximum, kUnbounded)));
      model.effects.push_back({effect, values, {}});
      expect_an_end(sound, &model);
    }
}

/// What the header of a file may say.
TEST(HostileMetadata, comes_to_an_end) {
  std::mt19937_64 rng(fresh_seed());
  const Capture sound = hostile_capture(Hostile::constant, 0, 500, rng);
  for (const auto &change : std::initializer_list<std::function<void(CaptureMetadata &)>>{
           [](CaptureMetadata &m) { m.periods_per_turn = 65536; },
           [](CaptureMetadata &m) { m.supply_v = 1e-6; },
           [](CaptureMetadata &m) { m.supply_v = 1e6; },
           [](CaptureMetadata &m) { m.noise_rms_v = 1e-300; },
           [](CaptureMetadata &m) { m.noise_rms_v = 1e6; },
           [](CaptureMetadata &m) { m.adc_bits = 1; },
           [](CaptureMetadata &m) { m.adc_reference_v = 1e-300; },
           [](CaptureMetadata &m) { m.sample_rate_hz = 1e-300; },
           [](CaptureMetadata &m) { m.sample_rate_hz = 1e9; }})
    for (const bool with_reference : {true, false}) {
      Capture c = sound;
      change(c.meta);
      if (!with_reference)
        c.reference_deg.clear();
      expect_an_end(c, nullptr);
    }
}

} // namespace
} // namespace ada::test
