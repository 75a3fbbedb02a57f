// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a diagnosis, the catalogue and the stored configurations say as values is what they say as
// text.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <string>

#include <nlohmann/json.hpp>

#include "handles.h"
#include "support/temp_folder.h"

namespace {

using api::initialised;
using api::make;
using nlohmann::json;

ada4571_diagnosis *diagnosis_of(const char *effect, double duration_s, bool has_reference) {
  auto baseline = initialised(ada4571_baseline_init);
  auto *model = make<ada4571_model>(ada4571_model_new, &baseline);
  EXPECT_EQ(ada4571_model_add_effect(model, effect), ADA4571_OK) << ada4571_last_error();
  auto options = initialised(ada4571_simulation_options_init);
  options.duration_s = duration_s;
  options.has_reference = has_reference;
  const ada4571_simulation_options *given = &options;
  auto *simulation = make<ada4571_simulation>(ada4571_simulation_new, model, given, 4571u);
  auto *recording = make<ada4571_recording>(ada4571_simulation_run, simulation);
  auto *diagnosis = make<ada4571_diagnosis>(
      ada4571_diagnose, recording, static_cast<const ada4571_diagnosis_options *>(nullptr));
  ada4571_recording_free(recording);
  ada4571_simulation_free(simulation);
  ada4571_model_free(model);
  return diagnosis;
}

/// A study's analysis of a capture, by a caller who ends it when it has asked `user` times.
int ends_at_zero(double, const char *, void *user) {
  return (*static_cast<int *>(user))-- > 0 ? 0 : 1;
}

TEST(Values, AnAnalysisThatItsCallerEndsIsNoRow) {
  const ada::test::TempFolder folder;
  const std::string path = folder / "capture.csv";
  auto simulated = initialised(ada4571_simulation_options_init);
  simulated.duration_s = 1.0;
  const ada4571_simulation_options *given = &simulated;
  auto *simulation = make<ada4571_simulation>(
      ada4571_simulation_new, static_cast<const ada4571_model *>(nullptr), given, 4571u);
  auto *recording = make<ada4571_recording>(ada4571_simulation_run, simulation);
  ASSERT_EQ(ada4571_recording_save(recording, path.c_str()), ADA4571_OK);
  auto options = initialised(ada4571_study_options_init);
  int left = 1;
  options.progress = ends_at_zero;
  options.user = &left;
  ada4571_study_row *row = nullptr;
  EXPECT_EQ(ada4571_study_analyse(path.c_str(), &options, &row), ADA4571_ERROR_STATE);
  EXPECT_EQ(row, nullptr);
  EXPECT_EQ(left, -1) << "asked again after it had ended";
  left = 1000000;
  EXPECT_EQ(ada4571_study_analyse(path.c_str(), &options, &row), ADA4571_OK);
  EXPECT_STREQ(ada4571_study_row_reason(row), "");
  EXPECT_LT(left, 1000000);
  ada4571_study_row_free(row);
  ada4571_recording_free(recording);
  ada4571_simulation_free(simulation);
}

void expect_same(double value, const json &text, const char *what) {
  if (text.is_null())
    EXPECT_TRUE(std::isnan(value)) << what;
  else
    EXPECT_DOUBLE_EQ(value, text.get<double>()) << what;
}

void expect_same_parameter(const ada4571_parameter &p, const json &parameters) {
  if (std::isnan(p.value)) {
    EXPECT_FALSE(parameters.contains(p.name));
    return;
  }
  ASSERT_TRUE(parameters.contains(p.name)) << p.name;
  const json &said = parameters[p.name];
  if (said["value"].is_string()) {
    EXPECT_EQ(said["value"], p.value < 0.5 ? "vsin" : "vcos");
    return;
  }
  expect_same(p.value, said["value"], p.name);
  expect_same(p.std_error, said["std_error"], p.name);
  EXPECT_EQ(said["unit"], p.unit);
}

void expect_same_finding(const ada4571_diagnosis *diagnosis, std::size_t i, const json &said) {
  auto f = initialised(ada4571_finding_init);
  ASSERT_EQ(ada4571_diagnosis_finding(diagnosis, i, &f), ADA4571_OK);
  EXPECT_EQ(said["cause"], f.cause);
  EXPECT_EQ(said["explanation"], f.explanation);
  EXPECT_EQ(said["separate_by"], f.separate_by);
  EXPECT_EQ(said["correctable"], f.correctable != 0);
  const json &gain = said["gain"];
  expect_same(f.residual_rms_before_v, gain["residual_rms_before_v"], "before");
  expect_same(f.residual_rms_after_v, gain["residual_rms_after_v"], "after");
  expect_same(f.log_likelihood_before, gain["log_likelihood_per_sample_before"], "before");
  expect_same(f.log_likelihood_after, gain["log_likelihood_per_sample_after"], "after");
  if (gain.contains("angle_error_rms_before_deg")) {
    expect_same(f.angle_error_rms_before_deg, gain["angle_error_rms_before_deg"], "before");
    expect_same(f.angle_error_rms_after_deg, gain["angle_error_rms_after_deg"], "after");
  } else {
    EXPECT_TRUE(std::isnan(f.angle_error_rms_before_deg));
  }
  for (std::size_t k = 0; k < f.parameters; ++k) {
    auto p = initialised(ada4571_parameter_init);
    ASSERT_EQ(ada4571_diagnosis_parameter(diagnosis, i, k, &p), ADA4571_OK);
    expect_same_parameter(p, said["parameters"]);
  }
  json alternatives = json::array();
  for (std::size_t k = 0; const char *name = ada4571_diagnosis_alternative(diagnosis, i, k); ++k)
    alternatives.push_back(name);
  EXPECT_EQ(said["alternatives"], alternatives);
  EXPECT_EQ(f.alternatives, alternatives.size());
  auto p = initialised(ada4571_parameter_init);
  EXPECT_EQ(ada4571_diagnosis_parameter(diagnosis, i, f.parameters, &p),
            ADA4571_ERROR_INVALID_ARGUMENT);
}

TEST(Values, findings_are_those_of_the_json) {
  for (const bool has_reference : {true, false}) {
    // Without a reference and at a single field a weak one has rivals.
    auto *diagnosis = diagnosis_of("weak-field:q=0.012", 4, has_reference);
    const json said = json::parse(ada4571_diagnosis_json(diagnosis))["findings"];
    ASSERT_GT(said.size(), 0u);
    ASSERT_EQ(ada4571_diagnosis_finding_count(diagnosis), said.size());
    for (std::size_t i = 0; i < said.size(); ++i)
      expect_same_finding(diagnosis, i, said[i]);
    auto f = initialised(ada4571_finding_init);
    EXPECT_EQ(ada4571_diagnosis_finding(diagnosis, said.size(), &f),
              ADA4571_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(ada4571_diagnosis_alternative(diagnosis, said.size(), 0), nullptr);
    ada4571_diagnosis_free(diagnosis);
  }
}

/// Two turns of a clean pair of two periods beside a reference of `unit` per degree.
ada4571_diagnosis *beside_a_reference(double unit) {
  const ada::test::TempFolder folder;
  const std::string path = folder / "capture.csv";
  std::FILE *file = std::fopen(path.c_str(), "w");
  std::fprintf(file, "# ada4571-capture/1\ntime_s,vsin_v,vcos_v,reference_deg\n");
  for (int i = 0; i < 3000; ++i) {
    const double turns = 2.0 * i / 3000, electrical = 4 * M_PI * turns;
    std::fprintf(file, "%.5f,%.6f,%.6f,%.6f\n", 0.001 * i,
                 2.5 + 1.7 * std::sin(electrical) + 0.001 * std::sin(1e3 * i * i),
                 2.5 + 1.7 * std::cos(electrical) + 0.001 * std::cos(1e3 * i * i),
                 unit * 360 * (turns - std::floor(turns)));
  }
  std::fclose(file);
  auto *recording = make<ada4571_recording>(ada4571_recording_open, path.c_str());
  auto *diagnosis = make<ada4571_diagnosis>(
      ada4571_diagnose, recording, static_cast<const ada4571_diagnosis_options *>(nullptr));
  ada4571_recording_free(recording);
  return diagnosis;
}

TEST(Values, a_reference_that_is_set_aside_is_told_with_the_sentence_of_the_json) {
  auto *sound = beside_a_reference(1);
  EXPECT_EQ(ada4571_diagnosis_reference_aside(sound), nullptr);
  ada4571_diagnosis_free(sound);
  auto *radians = beside_a_reference(M_PI / 180);
  const char *why = ada4571_diagnosis_reference_aside(radians);
  ASSERT_NE(why, nullptr);
  EXPECT_EQ(json::parse(ada4571_diagnosis_json(radians))["capture"]["reference_set_aside"], why);
  EXPECT_NE(ada4571_diagnosis_verdict(radians), ADA4571_EXPLAINED);
  ada4571_diagnosis_free(radians);
}

TEST(Values, a_model_comes_to_the_supply_of_a_source_and_to_no_other_sensors) {
  auto baseline = initialised(ada4571_baseline_init);
  baseline.supply_v = 4.0;
  baseline.amplitude_v = 1.16;
  auto *at_4v = make<ada4571_model>(ada4571_model_new, &baseline);
  auto options = initialised(ada4571_simulation_options_init);
  options.duration_s = 0.1;
  options.has_vtemp = 0;
  const ada4571_simulation_options *given = &options;
  auto *simulation = make<ada4571_simulation>(
      ada4571_simulation_new, static_cast<const ada4571_model *>(nullptr), given, 4571u);
  auto *source = make<ada4571_source>(ada4571_source_open_simulation, simulation, 0);
  auto info = initialised(ada4571_source_info_init);
  ASSERT_EQ(ada4571_source_get_info(source, &info), ADA4571_OK);
  const ada4571_source *const of = source;
  auto *here = make<ada4571_model>(ada4571_model_for_source, at_4v, of);
  ASSERT_EQ(ada4571_model_get_baseline(here, &baseline), ADA4571_OK);
  EXPECT_DOUBLE_EQ(baseline.supply_v, info.supply_v);
  EXPECT_NEAR(baseline.amplitude_v, 1.16 * info.supply_v / 4.0, 1e-12);

  ada4571_model *none = nullptr;
  baseline.periods_per_turn = 5;
  auto *of_five = make<ada4571_model>(ada4571_model_new, &baseline);
  EXPECT_EQ(ada4571_model_for_source(of_five, source, &none), ADA4571_ERROR_UNUSABLE_DATA);
  EXPECT_STREQ(ada4571_last_error(),
               "the calibration is for periods_per_turn = 5, the source says 2");
  baseline.periods_per_turn = 2;
  auto *of_heat = make<ada4571_model>(ada4571_model_new, &baseline);
  ASSERT_EQ(ada4571_model_add_effect(of_heat, "offset-temperature-drift:tc_sin=0.01"), ADA4571_OK);
  EXPECT_EQ(ada4571_model_for_source(of_heat, source, &none), ADA4571_ERROR_UNUSABLE_DATA);
  EXPECT_EQ(none, nullptr);
  for (ada4571_model *model : {at_4v, here, of_five, of_heat})
    ada4571_model_free(model);
  ada4571_source_free(source);
  ada4571_simulation_free(simulation);
}

/// NAME:parameter=value.
bool accepted(const ada4571_effect_info &effect, const ada4571_parameter &p, double value) {
  char text[200];
  std::snprintf(text, sizeof text, "%s:%s=%.17g", effect.id, p.name, value);
  auto baseline = initialised(ada4571_baseline_init);
  auto *model = make<ada4571_model>(ada4571_model_new, &baseline);
  const bool taken = ada4571_model_add_effect(model, text) == ADA4571_OK;
  ada4571_model_free(model);
  return taken;
}

TEST(Values, the_catalogues_ranges_are_those_that_are_accepted) {
  std::size_t limits = 0;
  for (std::size_t i = 0; i < ada4571_catalogue_count(); ++i) {
    auto effect = initialised(ada4571_effect_info_init);
    ASSERT_EQ(ada4571_catalogue_get(i, &effect), ADA4571_OK);
    for (std::size_t k = 0; k < effect.parameters; ++k) {
      auto p = initialised(ada4571_parameter_init);
      double low = 0, high = 0;
      ASSERT_EQ(ada4571_catalogue_parameter(i, k, &p), ADA4571_OK);
      ASSERT_EQ(ada4571_catalogue_range(i, k, &low, &high), ADA4571_OK);
      EXPECT_LE(low, high);
      if (std::isfinite(low)) {
        EXPECT_TRUE(accepted(effect, p, low)) << effect.id << " " << p.name << " " << low;
        EXPECT_FALSE(accepted(effect, p, low - 1 - std::abs(low))) << effect.id << " " << p.name;
        ++limits;
      }
      if (std::isfinite(high)) {
        EXPECT_TRUE(accepted(effect, p, high)) << effect.id << " " << p.name << " " << high;
        EXPECT_FALSE(accepted(effect, p, high + 1 + std::abs(high))) << effect.id << " " << p.name;
        ++limits;
      }
    }
  }
  EXPECT_GT(limits, 20u);
}

TEST(Values, every_example_of_a_motion_and_a_temperature_is_accepted) {
  for (std::size_t i = 0; i < 100; ++i) {
    auto options = initialised(ada4571_simulation_options_init);
    options.motion = ada4571_motion_example(i);
    options.temperature = ada4571_temperature_example(i);
    if (!options.motion && !options.temperature) {
      EXPECT_GE(i, 3u);
      return;
    }
    const ada4571_simulation_options *given = &options;
    ada4571_simulation_free(make<ada4571_simulation>(
        ada4571_simulation_new, static_cast<ada4571_model *>(nullptr), given, 1u));
  }
  FAIL() << "there is no end of examples";
}

TEST(Values, stored_configurations_are_listed_and_one_that_is_broken_hides_no_other) {
  ada::test::TempFolder home;
  setenv("XDG_CONFIG_HOME", (home / "").c_str(), 1);
  std::filesystem::create_directory(home / "ada4571");
  ada::test::write_file(home / "ada4571/wheel.toml",
                        "[source]\nuri = \"ip:bench\"\ndevice = \"ad7380\"\n"
                        "[calibration]\nfile = \"wheel-calibration.txt\"\n");
  ada::test::write_file(home / "ada4571/broken.toml", "nonsense");
  auto *list = make<ada4571_stored_list>(ada4571_stored_list_new, static_cast<char *>(nullptr));
  std::map<std::string, ada4571_stored> found;
  for (std::size_t i = 0; i < ada4571_stored_list_count(list); ++i) {
    auto stored = initialised(ada4571_stored_init);
    ASSERT_EQ(ada4571_stored_list_get(list, i, &stored), ADA4571_OK);
    found[stored.name] = stored;
  }
  ASSERT_TRUE(found.contains("wheel") && found.contains("broken"));
  EXPECT_STREQ(found["wheel"].uri, "ip:bench");
  EXPECT_STREQ(found["wheel"].device, "ad7380");
  EXPECT_EQ(std::filesystem::path(found["wheel"].calibration_file).lexically_normal(),
            std::filesystem::path(home / "ada4571/wheel-calibration.txt").lexically_normal());
  EXPECT_STREQ(found["wheel"].problem, "");
  EXPECT_NE(std::string(found["broken"].problem).find("broken.toml:1:"), std::string::npos);
  ada4571_stored_list_free(list);
  ada4571_stored_list *none = nullptr;
  EXPECT_EQ(ada4571_stored_list_new("broken", &none), ADA4571_ERROR_FORMAT);
  EXPECT_EQ(ada4571_stored_list_new("nosuch", &none), ADA4571_ERROR_NOT_FOUND);
  unsetenv("XDG_CONFIG_HOME");
}

} // namespace
