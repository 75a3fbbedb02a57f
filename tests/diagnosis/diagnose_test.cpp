// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/diagnose.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "base/parallel.h"
#include "diagnosis/captures.h"
#include "support/seed.h"

namespace ada::test {
namespace {

Capture with(const std::vector<const char *> &effects, std::mt19937_64 &rng, Drive drive = {}) {
  Model model = plain_sensor();
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
  EXPECT_EQ(d.nested.size(), 3u);
}

TEST(Diagnose, the_extended_model_leaves_nothing_to_find) {
  std::mt19937_64 rng(fresh_seed());
  const Capture c = with({"quadrature-error:delta_deg=0.5", "weak-field:q=0.01"}, rng);
  const Diagnosis first = diagnose(c, {});
  DiagnosisOptions again;
  again.baseline = &first.extended;
  const Diagnosis second = diagnose(c, again);
  EXPECT_TRUE(second.findings.empty());
  EXPECT_EQ(second.verdict, Verdict::explained);
}

TEST(Diagnose, noise_that_the_given_model_names_is_no_structure) {
  std::mt19937_64 rng(fresh_seed());
  Capture c = with({}, rng);
  std::normal_distribution<> turn(0.0, 0.002);
  const double middle = 0.5 * c.meta.supply_v;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double s = c.vsin_v[i] - middle, k = c.vcos_v[i] - middle, d = turn(rng);
    c.vsin_v[i] += d * k;
    c.vcos_v[i] -= d * s;
  }
  const Diagnosis first = diagnose(c, {});
  ASSERT_EQ(first.verdict, Verdict::explained);
  DiagnosisOptions again;
  again.baseline = &first.extended;
  const Diagnosis second = diagnose(c, again);
  EXPECT_TRUE(second.findings.empty());
  EXPECT_EQ(second.verdict, Verdict::explained);
}

/// What no cause of the catalogue makes: chips of the magnet, each at a place of its own.
Capture chipped(Capture c, double depth_v) {
  const auto chip = [](double deg, double at, double width) {
    const double x = wrap_centred(deg - at, 360.0) / width;
    return std::exp(-x * x);
  };
  for (std::size_t i = 0; i < c.size(); ++i) {
    c.vsin_v[i] += depth_v * chip(c.reference_deg[i], 100.0, 12.0);
    c.vcos_v[i] -= depth_v * chip(c.reference_deg[i], 235.0, 17.0);
  }
  return c;
}

TEST(Diagnose, the_verdict_on_a_model_does_not_depend_on_how_one_came_to_it) {
  std::mt19937_64 rng(fresh_seed());
  const Capture c = chipped(with({"quadrature-error:delta_deg=1.5"}, rng), 0.006);
  const Diagnosis first = diagnose(c, {});
  ASSERT_EQ(first.verdict, Verdict::partly_explained);
  ASSERT_TRUE(first.extended.remainder);
  DiagnosisOptions again;
  again.baseline = &first.extended;
  const Diagnosis second = diagnose(c, again);
  EXPECT_EQ(second.verdict, Verdict::partly_explained);
  EXPECT_TRUE(second.findings.empty());
  EXPECT_NEAR(second.unexplained_rms_v, first.unexplained_rms_v, 0.1 * first.unexplained_rms_v);
  // What the model carries without a name is a part of it, and counts in its figures.
  EXPECT_LT(second.baseline_quality.heldout.residual_rms_v,
            1.1 * first.extended_quality.heldout.residual_rms_v);
  // A model whose causes are not at work here explains nothing.
  const Capture sound = with({}, rng);
  EXPECT_EQ(diagnose(sound, {}).verdict, Verdict::no_discrepancy);
  // A model without causes is none that explains.
  const Capture only_chips = chipped(with({}, rng), 0.006);
  Model bare;
  again.baseline = &bare;
  const Diagnosis third = diagnose(only_chips, again);
  EXPECT_EQ(third.verdict,
            third.findings.empty() ? Verdict::unexplained : Verdict::partly_explained);
}

TEST(Diagnose, a_swing_within_a_turn_shows_mismatch_and_quadrature_without_a_reference) {
  std::mt19937_64 rng(fresh_seed());
  Model model = plain_sensor();
  model.effects = {parse_effect("amplitude-mismatch:k=0.05"),
                   parse_effect("quadrature-error:delta_deg=-2")};
  const Drive drive;
  ShaftMotion shaft;
  for (std::size_t i = 0; i < drive.samples; ++i) {
    // 200 of 360 electrical degrees: the middle of a channel's range is no centre.
    const double phase = kTwoPi * 0.7 * static_cast<double>(i) / drive.rate_hz;
    shaft.alpha.push_back(0.4 + 100.0 / model.periods_per_turn * kRadPerDeg * std::sin(phase));
    shaft.omega.push_back(0.0);
    shaft.direction.push_back(std::cos(phase) < 0.0 ? -1 : 1);
  }
  const Diagnosis d = diagnose(pair_of(model, shaft, drive.rate_hz, drive.noise_v, rng), {});
  ASSERT_EQ(d.findings.size(), 2u) << to_text(d);
  for (const Finding &f : d.findings) {
    const double truth = f.effect == find_effect("amplitude-mismatch") ? 0.05 : -2.0;
    EXPECT_NEAR(f.values[0], truth, 5.0 * f.std_errors[0]) << f.explanation;
  }
}

TEST(Diagnose, gives_the_same_for_any_number_of_threads) {
  std::mt19937_64 rng(fresh_seed());
  const Capture c = chipped(with({"quadrature-error:delta_deg=1.5"}, rng), 0.006);
  std::string first;
  for (unsigned threads : {1u, 3u}) {
    set_jobs(threads);
    const std::string json = to_json(diagnose(c, {}));
    set_jobs(0);
    if (first.empty())
      first = json;
    EXPECT_EQ(json, first) << threads << " threads";
  }
}

TEST(Diagnose, a_wild_sample_decides_nothing) {
  std::mt19937_64 rng(fresh_seed());
  for (const bool reference : {true, false}) {
    Capture c = with({}, rng);
    if (!reference)
      c.reference_deg.clear();
    const auto at = std::uniform_int_distribution<std::size_t>(100, c.size() - 100)(rng);
    (at % 2 == 0 ? c.vsin_v : c.vcos_v)[at] = at % 3 == 0 ? 999999.0 : -4000.0;
    const Diagnosis d = diagnose(c, {});
    EXPECT_EQ(d.verdict, Verdict::no_discrepancy)
        << "sample " << at << " with reference " << reference << (d.findings.empty() ? "" : ": " + d.findings[0].explanation)
        << (d.structure.empty() ? "" : ", " + d.structure[0].description);
    // Without a reference a residual of 0.5 mV is told to 15 %; of volts there must be nothing.
    EXPECT_LT(d.extended_quality.heldout.residual_rms_v, 8e-4);
  }
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
  few.samples = 10;
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

TEST(Diagnose, a_second_capture_with_other_offsets_still_judges_the_rest) {
  std::mt19937_64 rng(fresh_seed());
  const Capture train = with({"amplitude-mismatch:k=0.01"}, rng);
  Capture judge = with({"amplitude-mismatch:k=0.01"}, rng);
  for (double &v : judge.vsin_v)
    v += 0.030;
  DiagnosisOptions options;
  options.heldout = &judge;
  const Diagnosis d = diagnose(train, options);
  ASSERT_EQ(d.findings.size(), 1u);
  EXPECT_EQ(d.findings[0].effect, find_effect("amplitude-mismatch"));
  EXPECT_NEAR(d.extended_quality.heldout.residual_rms_v, 5e-4, 2e-5);
  // The move itself is said, and no cause is made up for it.
  EXPECT_EQ(d.verdict, Verdict::partly_explained);
  ASSERT_EQ(d.structure.size(), 1u);
  EXPECT_NE(d.structure[0].description.find("+30"), std::string::npos);
}

TEST(Diagnose, the_data_choose_whether_an_offset_comes_before_a_bent_transfer_or_after) {
  std::mt19937_64 rng(fresh_seed());
  const std::pair<const char *, bool> cases[] = {
      {"quadratic-nonlinearity:q2=0.015", false},
      {"quadratic-nonlinearity:q2=0.015,origin=1", true}};
  for (const auto &[text, after] : cases) {
    Model model = plain_sensor();
    model.baseline.offset_sin_v = 0.02;
    model.baseline.offset_cos_v = -0.025;
    model.effects.push_back(parse_effect(text));
    const Diagnosis d = diagnose(capture_of(model, Drive(), rng), {});
    ASSERT_EQ(d.findings.size(), 1u) << text << (d.findings.empty() ? "" : d.findings.back().explanation);
    EXPECT_NEAR(d.findings[0].values[0], 0.015, 1e-4);
    EXPECT_EQ(d.findings[0].values[1] == 1.0, after) << text;
  }
}

TEST(Diagnose, mid_supply_is_that_of_the_recorded_supply) {
  std::mt19937_64 rng(fresh_seed());
  Model model = plain_sensor();
  model.supply_v = 5.04;
  model.effects.push_back(parse_effect("cubic-nonlinearity:q3=0.015"));
  Capture c = capture_of(model, Drive(), rng);
  c.meta.supply_v = 5.0;
  std::normal_distribution<> noise(5.04, 1e-4);
  for (std::size_t i = 0; i < c.size(); ++i)
    c.vdd_v.push_back(noise(rng));
  const Diagnosis d = diagnose(c, {});
  ASSERT_EQ(d.findings.size(), 1u);
  EXPECT_NEAR(d.findings[0].values[0], 0.015, 1e-4);
  EXPECT_TRUE(std::isnan(d.findings[0].values[1]));
}

TEST(Diagnose, the_moment_of_a_step_is_exact_to_the_sample_at_any_place) {
  std::mt19937_64 rng(fresh_seed());
  for (int k = 0; k < 3; ++k) {
    const double time = std::uniform_real_distribution<>(1.5, 3.5)(rng);
    const Diagnosis d = diagnose(
        with({("offset-step:step_sin_v=0.006,step_cos_v=-0.009,time_s=" + std::to_string(time))
                  .c_str()},
             rng),
        {});
    ASSERT_EQ(d.findings.size(), 1u) << time;
    EXPECT_NEAR(d.findings[0].values[0], time, 5e-4) << "one sample at 2 kS/s";
    EXPECT_GT(d.findings[0].std_errors[0], 0.0);
  }
}

TEST(Diagnose, a_slip_and_a_loss_are_seen_without_a_reference) {
  std::mt19937_64 rng(fresh_seed());
  Drive steady;
  steady.turns_back = false;
  steady.slow_rpm = steady.fast_rpm = 500.0;
  Capture slip = with({"angle-slip:time_s=4.2,step_deg=-1.1"}, rng, steady);
  slip.reference_deg.clear();
  const Diagnosis slipped = diagnose(slip, {});
  ASSERT_EQ(slipped.findings.size(), 1u);
  EXPECT_EQ(slipped.findings[0].effect, find_effect("angle-slip"));
  EXPECT_NEAR(slipped.findings[0].values[0], 4.2, 1e-3);
  EXPECT_NEAR(slipped.findings[0].values[1], -1.1, 0.05);

  // 90 samples turn the shaft by 135 degrees: most of one electrical period.
  Capture loss = with({}, rng, steady);
  loss.reference_deg.clear();
  for (auto *column : {&loss.vsin_v, &loss.vcos_v}) {
    column->erase(column->begin() + 7000, column->begin() + 7090);
    loss.time_s.resize(column->size());
  }
  const Diagnosis lost = diagnose(loss, {});
  ASSERT_EQ(lost.findings.size(), 1u);
  EXPECT_EQ(lost.findings[0].effect, find_effect("sample-loss"));
  EXPECT_EQ(lost.findings[0].values[1], 90.0);
}

TEST(Diagnose, a_loss_that_turns_the_shaft_by_more_than_half_a_turn_is_counted) {
  std::mt19937_64 rng(fresh_seed());
  Drive steady;
  steady.turns_back = false;
  steady.slow_rpm = steady.fast_rpm = 600.0; // 1.8 degrees a sample
  Capture c = with({}, rng, steady);
  const std::size_t lost = std::uniform_int_distribution<std::size_t>(110, 190)(rng);
  for (auto *column : {&c.vsin_v, &c.vcos_v, &c.reference_deg}) {
    column->erase(column->begin() + 9000, column->begin() + 9000 + static_cast<long>(lost));
    c.time_s.resize(column->size());
  }
  const Diagnosis d = diagnose(c, {});
  ASSERT_EQ(d.findings.size(), 1u);
  EXPECT_EQ(d.findings[0].effect, find_effect("sample-loss"));
  EXPECT_EQ(d.findings[0].values[1], static_cast<double>(lost));
}

TEST(Diagnose, a_step_without_a_reference_is_no_rough_motion) {
  std::mt19937_64 rng(fresh_seed());
  Drive steady;
  steady.turns_back = false;
  steady.slow_rpm = steady.fast_rpm = 500.0;
  Capture c = with({"offset-step:time_s=7.5,step_sin_v=-0.004,step_cos_v=0.012"}, rng, steady);
  c.reference_deg.clear();
  const Diagnosis d = diagnose(c, {});
  ASSERT_EQ(d.findings.size(), 1u);
  EXPECT_EQ(d.findings[0].effect, find_effect("offset-step"));
  EXPECT_NEAR(d.findings[0].values[0], 7.5, 2e-3);
  EXPECT_GT(d.turns, 75.0) << "of 83: no stretch was dropped in silence";
}

TEST(Diagnose, a_shaft_that_turns_by_fits_and_starts_is_judged_by_the_radius) {
  std::mt19937_64 rng(fresh_seed());
  Model model = plain_sensor();
  model.effects.push_back(parse_effect("amplitude-mismatch:k=0.02"));
  Drive drive;
  drive.turns_back = false;
  Capture c = capture_of(model, drive, rng);
  // The same record as a hand would turn it: samples at the times of a jerky motion.
  Capture jerky = c;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const double t = static_cast<double>(i);
    const double to = t + 25.0 * std::sin(t / 17.0) + 14.0 * std::sin(t / 5.3 + 1.0);
    const auto k = static_cast<std::size_t>(std::clamp(to, 0.0, t + 40.0));
    const std::size_t from = std::min(k, c.size() - 1);
    jerky.vsin_v[i] = c.vsin_v[from];
    jerky.vcos_v[i] = c.vcos_v[from];
  }
  jerky.reference_deg.clear();
  const Diagnosis d = diagnose(jerky, {});
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings[0].effect, find_effect("amplitude-mismatch"));
  EXPECT_NEAR(d.findings[0].values[0], 0.02, 1e-3);
}

} // namespace
} // namespace ada::test
