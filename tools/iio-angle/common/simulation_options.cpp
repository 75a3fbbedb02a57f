// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/simulation_options.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "common/numbers.h"

namespace cli {

namespace {

ada4571_simulation_options for_library(const SimulationOptions &options) {
  ada4571_simulation_options numbers = options.numbers;
  if (!options.motion.empty())
    numbers.motion = options.motion.c_str();
  if (!options.temperature.empty())
    numbers.temperature = options.temperature.c_str();
  numbers.has_vtemp = !options.no_vtemp;
  numbers.has_vdd = !options.no_vdd;
  numbers.has_reference = !options.no_reference;
  return numbers;
}

/// Whether one of `--effect` names this effect.
bool named(const std::vector<std::string> &effects, std::string_view id) {
  return std::any_of(effects.begin(), effects.end(), [id](const std::string &effect) {
    return std::string_view(effect).substr(0, effect.find(':')) == id;
  });
}

/// An effect of a model as `--effect` would give it.
std::string effect_text(const Model &model, std::size_t index) {
  auto effect = initialised(ada4571_effect_info_init);
  check(ada4571_model_effect(model.get(), index, &effect));
  std::string text = effect.id;
  for (std::size_t i = 0; i < effect.parameters; ++i) {
    auto parameter = initialised(ada4571_parameter_init);
    check(ada4571_model_parameter(model.get(), index, i, &parameter));
    if (!std::isnan(parameter.value))
      text += fmt::format("{}{}={:.17g}", i == 0 ? ':' : ',', parameter.name, parameter.value);
  }
  return text;
}

/// The sensor that the seed alone gives, but for what `--effect` says otherwise.
Model drawn_model(const SimulationOptions &options, const ada4571_simulation_options &numbers) {
  const auto plain = make_as_asked<Simulation>(
      ada4571_simulation_new, static_cast<const ada4571_model *>(nullptr), &numbers, options.seed);
  const auto drawn = make<Model>(ada4571_simulation_model, plain.get());
  auto baseline = initialised(ada4571_baseline_init);
  check(ada4571_model_get_baseline(drawn.get(), &baseline));
  auto model = make<Model>(ada4571_model_new, &baseline);
  for (std::size_t i = 0; i < ada4571_model_effect_count(drawn.get()); ++i) {
    const std::string text = effect_text(drawn, i);
    if (!named(options.effects, std::string_view(text).substr(0, text.find(':'))))
      check(ada4571_model_add_effect(model.get(), text.c_str()));
  }
  return model;
}

} // namespace

void add_simulation_options(CLI::App &verb, SimulationOptions &options) {
  ada4571_simulation_options &n = options.numbers;
  verb.add_option("--model", options.model,
                  "model file of the sensor (default: a sound ADA4571 drawn from the seed)")
      ->type_name("FILE");
  verb.add_option("--effect", options.effects,
                  "add an effect, NAME or NAME:parameter=value,...; may be given again "
                  "(`iio-angle catalogue` lists them)")
      ->type_name("EFFECT")
      ->allow_extra_args(false);
  verb.add_option("--seed", options.seed, "seed of everything random")
      ->capture_default_str()
      ->type_name("N");
  verb.add_option("--motion", options.motion,
                  "constant:rpm=600, steps:rpm=60/600/-600, ... (docs/simulation.md)")
      ->type_name("PROFILE");
  verb.add_option("--temperature", options.temperature,
                  "constant:deg_c=25, ramp:from=-20,to=100, cycle:...")
      ->type_name("PROFILE");
  verb.add_option("--rate", n.sample_rate_hz, "sample rate, in Hz")
      ->capture_default_str()
      ->check(kPositive)
      ->type_name("HZ");
  verb.add_option("--duration", n.duration_s, "length, in s")
      ->capture_default_str()
      ->check(kNonNegative)
      ->type_name("S");
  verb.add_option("--noise", n.noise_rms_v, "white noise, in V rms")
      ->capture_default_str()
      ->check(kNonNegative)
      ->type_name("V");
  verb.add_option("--bits", n.adc_bits, "bits of the converter, 0 for none")
      ->capture_default_str()
      ->check(CLI::Range(0, 32))
      ->type_name("N");
  verb.add_option("--adc-reference", n.adc_reference_v, "full scale of the converter, in V")
      ->capture_default_str()
      ->check(kPositive)
      ->type_name("V");
  verb.add_flag("--no-vtemp", options.no_vtemp, "leave the VTEMP channel out");
  verb.add_flag("--no-vdd", options.no_vdd, "leave the VDD channel out");
  verb.add_flag("--no-reference", options.no_reference, "leave the reference encoder out");
}

Simulation make_simulation(const SimulationOptions &options) {
  const ada4571_simulation_options numbers = for_library(options);
  Model model;
  if (!options.model.empty())
    model = make<Model>(ada4571_model_load, options.model.c_str());
  else if (!options.effects.empty())
    model = drawn_model(options, numbers);
  for (const std::string &effect : options.effects)
    check_usage(ada4571_model_add_effect(model.get(), effect.c_str()));
  const auto simulate = [&](const ada4571_model *of) {
    return make_as_asked<Simulation>(ada4571_simulation_new, of, &numbers, options.seed);
  };
  if (options.model.empty())
    return simulate(model.get());
  simulate(nullptr); // what is refused beyond this is the file's fault, not the command line's
  return make<Simulation>(ada4571_simulation_new, static_cast<const ada4571_model *>(model.get()),
                          &numbers, options.seed);
}

} // namespace cli
