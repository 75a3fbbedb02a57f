// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What every effect object of the catalogue says of itself, as JSON for the documentation.
#include <iostream>

#include <nlohmann/json.hpp>

#include "model/effect.h"

int main() {
  using Json = nlohmann::ordered_json;
  const auto number = [](double value) {
    return Json(value).dump() == "null" ? Json("none") : Json(value);
  };
  const auto evidence = [](ada::Evidence seen) {
    switch (seen) {
    case ada::Evidence::signal:
      return "signal";
    case ada::Evidence::screening:
      return "screening";
    case ada::Evidence::noise:
      return "noise";
    case ada::Evidence::process:
      return "process";
    }
    return "";
  };
  Json facts = Json::array();
  for (const ada::Effect *effect : ada::catalogue()) {
    const ada::EffectInfo &info = effect->info();
    Json parameters = Json::array(), separations = Json::array();
    for (const ada::ParameterInfo &p : info.parameters)
      parameters.push_back({{"name", p.name},
                            {"unit", p.unit},
                            {"fallback", number(p.fallback)},
                            {"minimum", number(p.minimum)},
                            {"maximum", number(p.maximum)}});
    for (const ada::Separation &s : info.separations)
      separations.push_back({{"rival", s.rival}, {"experiment", s.experiment}});
    facts.push_back({{"id", info.id},
                     {"cause", info.cause},
                     {"stage", ada::stage_name(info.stage)},
                     {"correctable", info.correctable},
                     {"evidence", evidence(info.evidence)},
                     {"parameters", parameters},
                     {"separations", separations}});
  }
  std::cout << facts.dump(1) << "\n";
}
