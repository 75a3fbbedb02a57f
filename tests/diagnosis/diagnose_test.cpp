// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/diagnose.h"

#include <random>

#include <gtest/gtest.h>

#include "diagnosis/captures.h"
#include "support/seed.h"

namespace ada::test {
namespace {

Capture with(const std::vector<const char *> &effects, std::mt19937_64 &rng, Drive drive = {}) {
  Model model = sound_sensor();
  for (const char *text : effects)
    model.effects.push_back(parse_effect(text));
  return capture_of(model, drive, rng);
}

TEST(Diagnose, a_clean_capture_has_no_discrepancy) {
  std::mt19937_64 rng(fresh_seed());
  const Diagnosis d = diagnose(with({}, rng), {});
  EXPECT_EQ(d.verdict, Verdict::no_discrepancy);
  EXPECT_TRUE(d.findings.empty());
  EXPECT_NEAR(d.extended_quality.heldout.residual_rms_v, 5e-4, 2e-5);
}

TEST(Diagnose, findings_come_largest_first_with_falling_residuals) {
  std::mt19937_64 rng(fresh_seed());
  const Diagnosis d = diagnose(
      with({"amplitude-mismatch:k=0.012", "stray-field:b=0.004,direction_deg=70"}, rng), {});
  ASSERT_EQ(d.findings.size(), 2u);
  EXPECT_EQ(d.verdict, Verdict::explained);
  EXPECT_EQ(d.findings[0].effect, find_effect("amplitude-mismatch"));
  EXPECT_EQ(d.findings[1].effect, find_effect("stray-field"));
  for (const Finding &f : d.findings)
    EXPECT_LT(f.after.heldout.residual_rms_v, f.before.heldout.residual_rms_v);
  EXPECT_NEAR(d.findings[0].values[0], 0.012, 5e-5);
  EXPECT_EQ(d.ladder.size(), 3u);
}

TEST(Diagnose, the_extended_model_leaves_nothing_to_find) {
  std::mt19937_64 rng(fresh_seed());
  const Capture c = with({"quadrature-error:delta_deg=0.5", "weak-field:q=0.01"}, rng);
  const Diagnosis first = diagnose(c, {});
  DiagnosisOptions again;
  again.baseline = &first.extended;
  EXPECT_EQ(diagnose(c, again).verdict, Verdict::no_discrepancy);
}

TEST(Diagnose, names_both_of_two_that_look_the_same) {
  std::mt19937_64 rng(fresh_seed());
  const Diagnosis d = diagnose(with({"weak-field:q=0.012"}, rng), {});
  ASSERT_EQ(d.findings.size(), 1u);
  EXPECT_EQ(d.findings[0].alternatives, std::vector<std::string>{"cubic-nonlinearity"});
  EXPECT_FALSE(d.findings[0].separate_by.empty());
}

TEST(Diagnose, a_few_samples_or_a_standstill_are_not_enough) {
  std::mt19937_64 rng(fresh_seed());
  Drive few;
  few.samples = 100;
  EXPECT_EQ(diagnose(with({}, rng, few), {}).verdict, Verdict::insufficient_data);
  Drive still;
  still.slow_rpm = still.fast_rpm = 0.0;
  const Diagnosis d = diagnose(with({}, rng, still), {});
  EXPECT_EQ(d.verdict, Verdict::insufficient_data);
  EXPECT_FALSE(d.reason.empty());
}

TEST(Diagnose, a_second_capture_judges_with_its_own_zero_angle) {
  std::mt19937_64 rng(fresh_seed());
  const Capture train = with({"amplitude-mismatch:k=0.01"}, rng);
  Capture judge = with({"amplitude-mismatch:k=0.01"}, rng);
  for (double &r : judge.reference_deg)
    r = wrap(r + 40.0, 360.0);
  DiagnosisOptions options;
  options.heldout = &judge;
  const Diagnosis d = diagnose(train, options);
  ASSERT_EQ(d.findings.size(), 1u);
  EXPECT_NEAR(d.extended_quality.heldout.residual_rms_v, 5e-4, 2e-5);
}

} // namespace
} // namespace ada::test
