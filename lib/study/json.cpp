// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// "ada4571-study/1". Keys keep their order, so that two runs can be compared as text.

#include <cmath>

#include <nlohmann/json.hpp>

#include "study/summary.h"

namespace ada::study {

namespace {

using Json = nlohmann::ordered_json;

Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}

Json number(const std::optional<double> &x) {
  return x ? number(*x) : Json(nullptr);
}

Json parameters_of(const CauseSummary &c) {
  Json out = Json::object();
  for (const ParameterSummary &p : c.parameters) {
    Json &j = out[p.parameter];
    j = {{"median", number(p.median)}, {"mad", number(p.mad)}};
    j["between_sensors"] = p.components ? number(p.components->between) : Json(nullptr);
    j["within_sensor"] = p.components ? number(p.components->within) : Json(nullptr);
    j["unit"] = p.unit;
    j["captures"] = p.count;
  }
  return out;
}

Json causes_of(const std::vector<CauseSummary> &causes) {
  Json out = Json::array();
  for (const CauseSummary &c : causes)
    out.push_back({{"cause", c.cause},
                   {"found_in", c.found_in},
                   {"share", number(c.share)},
                   {"parameters", parameters_of(c)},
                   {"angle_rms_deg", number(c.angle_rms_deg)},
                   {"fleet_angle_deg", number(c.fleet_cost_deg)}});
  return out;
}

Json dependences_of(const Summary &s) {
  Json out = Json::array();
  for (const Dependence &d : s.dependences) {
    Json j = {{"cause", d.cause}, {"parameter", d.parameter}, {"on", d.on}};
    if (d.numeric) {
      j["slope"] = number(d.trend->slope);
      j["std_error"] = number(d.trend->std_error);
    } else {
      j["levels"] = Json::array();
      for (const Level &l : d.levels)
        j["levels"].push_back(
            {{"value", l.word}, {"median", number(l.median)}, {"units", l.count}});
    }
    j["unit"] = d.unit;
    j["within_sensors"] = d.within_sensors;
    j["p_adjusted"] = number(d.p_adjusted);
    out.push_back(j);
  }
  return out;
}

Json groups_of(const Summary &s) {
  Json out = Json::array();
  for (const Grouping &g : s.groups) {
    Json j = {{"cause", g.cause}, {"parameter", g.parameter}, {"unit", g.unit}};
    j["centres"] = j["spreads"] = Json::array();
    for (const Population &p : g.populations) {
      j["centres"].push_back(number(p.centre));
      j["spreads"].push_back(number(p.spread));
    }
    j["sizes"] = g.sizes;
    j["goes_with"] = g.goes_with ? Json{{"key", g.goes_with->key},
                                        {"p_adjusted", number(g.goes_with->p_adjusted)}}
                                 : Json(nullptr);
    out.push_back(j);
  }
  return out;
}

Json outliers_of(const Summary &s) {
  Json out = Json::array();
  for (const Outlier &o : s.outliers)
    out.push_back({{"capture", o.capture},
                   {"serial", o.serial},
                   {"cause", o.cause},
                   {"parameter", o.parameter},
                   {"value", number(o.value)},
                   {"z", number(o.z)},
                   {"sentence", o.sentence}});
  return out;
}

Json sufficient_of(const Sufficient &s) {
  Json out;
  out["effects"] = s.chosen ? Json(s.candidates[*s.chosen].effects) : Json::array();
  out["heldout_angle_rms_deg"] = s.chosen ? number(s.candidates[*s.chosen].heldout) : Json(nullptr);
  out["name"] = s.chosen ? Json(s.candidates[*s.chosen].name) : Json(nullptr);
  out["name_new_sensors"] = s.chosen_new ? Json(s.candidates[*s.chosen_new].name) : Json(nullptr);
  out["sentence"] = s.sentence;
  out["candidates"] = Json::array();
  for (const Candidate &c : s.candidates)
    out["candidates"].push_back({{"name", c.name},
                                 {"effects", c.effects},
                                 {"same_capture_deg", number(c.same_capture)},
                                 {"same_sensor_deg", number(c.same_sensor)},
                                 {"new_sensor_deg", number(c.new_sensor)}});
  return out;
}

} // namespace

std::string to_json(const Summary &s) {
  const Json out = {{"schema", "ada4571-study/1"},
                    {"captures", s.captures},
                    {"failed", s.failed},
                    {"waiting", s.waiting},
                    {"not_sound", s.unsound},
                    {"sensors", s.sensors},
                    {"diagnosed", s.diagnosed},
                    {"causes", causes_of(s.causes)},
                    {"baseline", causes_of(s.baseline)},
                    {"tests", s.tests},
                    {"dependences", dependences_of(s)},
                    {"groups", groups_of(s)},
                    {"outliers", outliers_of(s)},
                    {"sufficient_model", sufficient_of(s.sufficient)}};
  return out.dump(1, ' ', false, Json::error_handler_t::replace);
}

} // namespace ada::study
