// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/handles.h"
#include "common/known_names.h"
#include "common/option_checks.h"
#include "common/print.h"
#include "common/verb.h"

namespace cli {

namespace {

using Json = nlohmann::ordered_json;

struct CatalogueOptions {
  std::vector<std::string> names;
  bool json = false;
};

struct Parameter {
  ada4571_parameter info = initialised(ada4571_parameter_init);
  double minimum = 0, maximum = 0;
};

struct Effect {
  ada4571_effect_info info = initialised(ada4571_effect_info_init);
  std::vector<Parameter> parameters;
};

Effect effect_at(std::size_t index) {
  Effect effect;
  check(ada4571_catalogue_get(index, &effect.info));
  effect.parameters.resize(effect.info.parameters);
  for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
    Parameter &p = effect.parameters[i];
    check(ada4571_catalogue_parameter(index, i, &p.info));
    check(ada4571_catalogue_range(index, i, &p.minimum, &p.maximum));
  }
  return effect;
}

bool is_channel(const Parameter &p) {
  return std::string_view(p.info.unit) == "channel";
}

std::string value_text(const Parameter &p) {
  if (std::isnan(p.info.value))
    return "absent";
  return is_channel(p) ? (p.info.value < 0.5 ? "vsin" : "vcos") : fmt::format("{:g}", p.info.value);
}

std::string range_text(const Parameter &p) {
  if (is_channel(p))
    return "vsin or vcos";
  if (std::isinf(p.minimum) && std::isinf(p.maximum))
    return "any";
  if (std::isinf(p.maximum))
    return fmt::format("{:g} or above", p.minimum);
  if (std::isinf(p.minimum))
    return fmt::format("{:g} or below", p.maximum);
  return fmt::format("{:g} to {:g}", p.minimum, p.maximum);
}

void print_text(const Effect &effect) {
  print("{}  ({})\n  {}\n", effect.info.id, effect.info.stage, effect.info.cause);
  for (const Parameter &p : effect.parameters)
    print("    {:<16} {:<8} default {:<10} {}\n", p.info.name, is_channel(p) ? "" : p.info.unit,
          value_text(p), range_text(p));
}

/// JSON knows no infinity: what has no limit, or is absent, is null.
Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}

Json to_json(const Effect &effect) {
  Json parameters = Json::array();
  for (const Parameter &p : effect.parameters) {
    Json &out = parameters.emplace_back(Json{{"name", p.info.name}});
    if (is_channel(p)) {
      out["unit"] = "";
      out["default"] = std::isnan(p.info.value) ? Json(nullptr) : Json(value_text(p));
      out["choices"] = {"vsin", "vcos"};
      continue;
    }
    out["unit"] = p.info.unit;
    out["default"] = number(p.info.value);
    out["minimum"] = number(p.minimum);
    out["maximum"] = number(p.maximum);
  }
  return {{"id", effect.info.id},
          {"cause", effect.info.cause},
          {"stage", effect.info.stage},
          {"correctable", effect.info.correctable != 0},
          {"parameters", parameters}};
}

int run(const CatalogueOptions &options) {
  Json effects = Json::array();
  for (std::size_t i = 0; i < ada4571_catalogue_count(); ++i) {
    const Effect effect = effect_at(i);
    const auto &names = options.names;
    if (!names.empty() && std::find(names.begin(), names.end(), effect.info.id) == names.end())
      continue;
    if (options.json)
      effects.push_back(to_json(effect));
    else
      print_text(effect);
  }
  if (options.json)
    print("{}\n", Json{{"schema", "ada4571-catalogue/1"}, {"effects", effects}}.dump(1));
  return kDone;
}

} // namespace

void add_catalogue(CLI::App &app, Action &action) {
  auto *verb =
      app.add_subcommand("catalogue", "the effects that a model can hold, with their parameters");
  auto options = std::make_shared<CatalogueOptions>();
  verb->add_option("NAME", options->names, "effects to show (default: all)")
      ->transform(one_of(effect_names(), "effect").description(""));
  verb->add_flag("--json", options->json, "print JSON (ada4571-catalogue/1) instead of text");
  example(*verb, "  iio-angle catalogue | less\n"
                 "  iio-angle catalogue channel-skew\n"
                 "  iio-angle catalogue --json | jq -r '.effects[].id'");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
