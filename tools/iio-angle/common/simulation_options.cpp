// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/simulation_options.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/file_roles.h"
#include "common/known_names.h"
#include "common/option_checks.h"
#include "common/quantity.h"
#include "common/spelling.h"

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

/// "'constnat' is not a motion" and what may have been meant, before the library refuses it with
/// less of a clue.
void require_known(const char *option, std::string_view what, std::string_view name,
                   const std::vector<std::string> &known, const char *see) {
  if (std::find(known.begin(), known.end(), name) == known.end())
    throw Failure(kWrongUsage, fmt::format("{}: '{}' is no {}{}", option, name, what,
                                           did_you_mean(name, known, see)));
}

constexpr double kMostRate_hz = 1e8; ///< of the library
constexpr const char *kSeeManual = "man iio-angle-simulate";

/// A motion or a course of the temperature, likewise (see below); `examples` are one a kind.
std::string in_plain_numbers(const char *option, std::string_view what, const std::string &text,
                             const std::vector<std::string> &examples,
                             const char *(*unit_of)(std::string_view key)) {
  if (text.empty())
    return text;
  const std::string kind(kind_of(text));
  require_known(option, what, kind, kinds_of(examples), kSeeManual);
  const std::vector<std::string> keys = keys_of(examples, kind);
  return with_plain_numbers(text, [&](std::string_view key) {
    if (!key.empty()) // "constant:" is all that is not given
      require_known(option, fmt::format("parameter of {} ({})", kind, fmt::join(keys, ", ")), key,
                    keys, kSeeManual);
    return std::string(unit_of(key));
  });
}

/// Names are checked, and 4us, 10% and 600rpm turned into the plain numbers that the library takes.
SimulationOptions in_plain_numbers(SimulationOptions options) {
  for (std::string &effect : options.effects) {
    const std::string name(kind_of(effect));
    require_known("--effect", "effect", name, effect_names(), "iio-angle catalogue");
    effect = with_plain_numbers(effect, [&](std::string_view key) {
      require_known("--effect", "parameter of " + name, key, parameter_names(name),
                    ("iio-angle catalogue " + name).c_str());
      return parameter_unit(name, key);
    });
  }
  options.motion =
      in_plain_numbers("--motion", "motion", options.motion, motion_examples(),
                       [](std::string_view key) { return key == "transition" ? "1" : "rpm"; });
  options.temperature =
      in_plain_numbers("--temperature", "course of the temperature", options.temperature,
                       temperature_examples(), [](std::string_view) { return "C"; });
  return options;
}

/// What the library refuses of an option, with the option's name before it.
void require_option(const char *option, ada4571_status status) {
  if (status == ADA4571_ERROR_INVALID_ARGUMENT)
    throw Failure(kWrongUsage, fmt::format("{}: {}", option, ada4571_last_error()));
  check(status);
}

void add_effect(const Model &model, const std::string &text) {
  require_option("--effect", ada4571_model_add_effect(model.get(), text.c_str()));
}

/// Tries them one by one, so that what is refused has an option's name.
void require_profiles(const ada4571_simulation_options &numbers) {
  const auto attempt = [](const char *option, const char *ada4571_simulation_options::*member,
                          const char *text) {
    auto only = initialised(ada4571_simulation_options_init);
    only.*member = text;
    ada4571_simulation *simulation = nullptr;
    require_option(option, ada4571_simulation_new(nullptr, &only, 0, &simulation));
    ada4571_simulation_free(simulation);
  };
  auto length = initialised(ada4571_simulation_options_init);
  length.sample_rate_hz = numbers.sample_rate_hz;
  length.duration_s = numbers.duration_s;
  ada4571_simulation *simulation = nullptr;
  require_option("--duration", ada4571_simulation_new(nullptr, &length, 0, &simulation));
  ada4571_simulation_free(simulation);
  attempt("--motion", &ada4571_simulation_options::motion, numbers.motion);
  attempt("--temperature", &ada4571_simulation_options::temperature, numbers.temperature);
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
      ->transform(whole(0))
      ->type_name("N");
  verb.add_option("--motion", options.motion,
                  "constant:rpm=600, ramp:from=R,to=R, steps:rpm=60/600/-600,transition=PART")
      ->type_name("PROFILE");
  verb.add_option("--temperature", options.temperature,
                  "constant:deg_c=25, ramp:from=-20,to=100, cycle:from=0,to=80")
      ->type_name("PROFILE");
  verb.add_option("--rate", n.sample_rate_hz, "sample rate, in Hz")
      ->capture_default_str()
      ->transform(positive("Hz"))
      ->transform(between(0.0, kMostRate_hz, "Hz"))
      ->type_name("HZ");
  verb.add_option("--duration", n.duration_s, "length, in s")
      ->capture_default_str()
      ->transform(from_zero("s"))
      ->type_name("S");
  verb.add_option("--noise", n.noise_rms_v, "white noise, in V rms")
      ->capture_default_str()
      ->transform(from_zero("V"))
      ->type_name("V");
  verb.add_option("--bits", n.adc_bits, "bits of the converter, 0 for none")
      ->capture_default_str()
      ->transform(whole(0, 32))
      ->type_name("N");
  verb.add_option("--adc-reference", n.adc_reference_v, "full scale of the converter, in V")
      ->capture_default_str()
      ->transform(positive("V"))
      ->type_name("V");
  verb.add_flag("--no-vtemp", options.no_vtemp, "leave the VTEMP channel out");
  verb.add_flag("--no-vdd", options.no_vdd, "leave the VDD channel out");
  verb.add_flag("--no-reference", options.no_reference, "leave the reference encoder out");
}

Simulation make_simulation(const SimulationOptions &as_written) {
  const SimulationOptions options = in_plain_numbers(as_written);
  const ada4571_simulation_options numbers = for_library(options);
  require_profiles(numbers);
  Model model;
  if (!options.model.empty())
    model = load_model(options.model);
  else if (!options.effects.empty())
    model = drawn_model(options, numbers);
  for (const std::string &effect : options.effects)
    add_effect(model, effect);
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
