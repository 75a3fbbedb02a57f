// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// "ada4571-diagnosis/1". Keys keep their order, so that two runs can be compared as text.

#include <cmath>
#include <nlohmann/json.hpp>

#include "diagnosis/diagnose.h"

namespace ada {

namespace {

using nlohmann::ordered_json;

/// JSON knows no infinity and no NaN.
ordered_json number(double x) {
  return std::isfinite(x) ? ordered_json(x) : ordered_json(nullptr);
}

ordered_json parameters_of(const Effect &effect, const std::vector<double> &values,
                           const std::vector<double> &errors) {
  ordered_json out = ordered_json::object();
  const auto parameters = effect.info().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    if (std::isnan(values[k]))
      continue;
    ordered_json &p = out[std::string(parameters[k].name)];
    if (parameters[k].unit == "channel")
      p["value"] = values[k] < 0.5 ? "vsin" : "vcos";
    else
      p["value"] = number(values[k]);
    p["std_error"] = k < errors.size() ? number(errors[k]) : ordered_json(nullptr);
    p["unit"] = parameters[k].unit == "channel" ? "" : std::string(parameters[k].unit);
  }
  return out;
}

/// Error 0: it is not known.
ordered_json value_with_error(double value, double error, const char *unit) {
  return {{"value", number(value)},
          {"std_error", error > 0.0 ? number(error) : ordered_json(nullptr)},
          {"unit", unit}};
}

ordered_json baseline_parameters(const Model &m) {
  const Baseline &b = m.baseline, &e = m.baseline_std_error;
  return {{"amplitude_v", value_with_error(b.amplitude_v, e.amplitude_v, "V")},
          {"offset_sin_v", value_with_error(b.offset_sin_v, e.offset_sin_v, "V")},
          {"offset_cos_v", value_with_error(b.offset_cos_v, e.offset_cos_v, "V")},
          {"angle_zero_deg", value_with_error(b.angle_zero_deg, e.angle_zero_deg, "deg")}};
}

ordered_json quality(const Quality &q) {
  ordered_json out;
  out["residual_rms_v"] = number(q.residual_rms_v);
  if (q.angle_error_rms_deg)
    out["angle_error_rms_deg"] = number(*q.angle_error_rms_deg);
  out["log_likelihood_per_sample"] = number(q.log_likelihood);
  return out;
}

ordered_json gain(const Finding &f) {
  const Quality &before = f.before.heldout, &after = f.after.heldout;
  ordered_json out;
  out["residual_rms_before_v"] = number(before.residual_rms_v);
  out["residual_rms_after_v"] = number(after.residual_rms_v);
  if (before.angle_error_rms_deg && after.angle_error_rms_deg) {
    out["angle_error_rms_before_deg"] = number(*before.angle_error_rms_deg);
    out["angle_error_rms_after_deg"] = number(*after.angle_error_rms_deg);
  }
  out["log_likelihood_per_sample_before"] = number(before.log_likelihood);
  out["log_likelihood_per_sample_after"] = number(after.log_likelihood);
  return out;
}

ordered_json budget(const std::vector<BudgetLine> &lines) {
  ordered_json out = ordered_json::array();
  for (const BudgetLine &line : lines)
    out.push_back({{"axis", axis_name(line.axis)},
                   {"rms_v", number(line.rms_v)},
                   {"named_rms_v", number(line.named_rms_v)},
                   {"unnamed_rms_v", number(line.unnamed_rms_v)}});
  return out;
}

/// Orders that hold a hundredth of the remainder's power or more.
ordered_json remainder(const Diagnosis &d) {
  ordered_json out;
  const auto &r = d.extended.remainder;
  out["present"] = r.has_value();
  out["rms_v"] = number(d.remainder_rms_v);
  if (d.by_reference())
    out["angle_rms_deg"] = number(d.remainder_angle_rms_deg);
  ordered_json orders = ordered_json::array();
  std::size_t highest = 0;
  for (std::size_t n = 0; r && n < r->orders(); ++n) {
    const double power = r->sin_cos[n] * r->sin_cos[n] + r->sin_sin[n] * r->sin_sin[n] +
                         r->cos_cos[n] * r->cos_cos[n] + r->cos_sin[n] * r->cos_sin[n];
    highest = power > 0.0 ? n + 1 : highest;
    if (0.25 * power > 0.01 * r->rms() * r->rms())
      orders.push_back(n + 1);
  }
  out["highest_order"] = highest;
  out["orders"] = orders;
  return out;
}

/// The interface knows no structure along the supply: that goes on in time, and its sentence says
/// what with.
std::string_view along(const Structure &s) {
  return s.along == axis_name(Axis::supply) ? axis_name(Axis::time) : std::string_view(s.along);
}

} // namespace

std::string to_json(const Diagnosis &d) {
  ordered_json out;
  out["schema"] = "ada4571-diagnosis/1";
  out["capture"] = {{"samples", d.samples},     {"duration_s", number(d.duration_s)},
                    {"turns", number(d.turns)}, {"periods_per_turn", d.periods_per_turn},
                    {"channels", d.channels},   {"has_reference", d.has_reference}};
  if (!d.reference_aside.empty())
    out["capture"]["reference_set_aside"] = d.reference_aside;
  if (d.rows_a_reading > 1.0) {
    out["capture"]["rows_a_reading"] = d.rows_a_reading;
    out["capture"]["held"] = d.held_reference ? "reference" : "pair";
  }
  if (d.readings_a_stop > 1.0)
    out["capture"]["readings_a_stop"] = d.readings_a_stop;
  if (d.reference_course) {
    const ReferenceCourse &c = *d.reference_course;
    if (c.scale_error > 0.0)
      out["capture"]["reference_scale"] = {
          {"value", c.scale}, {"std_error", c.scale_error}, {"unit", "1"}};
    if (c.clock_error > 0.0)
      out["capture"]["reference_clock"] = {
          {"value", c.clock_ppm}, {"std_error", c.clock_error}, {"unit", "ppm"}};
    if (c.drift_error > 0.0)
      out["capture"]["reference_drift"] = {{"value", c.drift_deg_s},
                                           {"std_error", c.drift_error},
                                           {"unit", "deg/s"},
                                           {"bend_deg", c.bend_deg}};
  }
  const bool judged = d.verdict != Verdict::insufficient_data;
  if (judged)
    out["baseline"] = {{"model", d.baseline_name},
                       {"parameters", baseline_parameters(d.baseline)},
                       {"heldout", quality(d.baseline_quality.heldout)},
                       {"in_sample", quality(d.baseline_quality.in_sample)}};
  else
    out["baseline"] = {{"model", d.baseline_name}, {"parameters", ordered_json::object()}};
  out["findings"] = ordered_json::array();
  for (const Finding &f : d.findings)
    out["findings"].push_back({{"cause", f.effect->info().id},
                               {"alternatives", f.alternatives},
                               {"separate_by", f.separate_by},
                               {"explanation", f.explanation},
                               {"parameters", parameters_of(*f.effect, f.values, f.std_errors)},
                               {"gain", gain(f)},
                               {"correctable", f.correctable}});
  if (judged)
    out["extended"] = {{"heldout", quality(d.extended_quality.heldout)},
                       {"in_sample", quality(d.extended_quality.in_sample)}};
  if (judged) {
    out["anonymous"] = {{"heldout", quality(d.anonymous)}};
    out["budget"] = budget(d.budget);
    out["remainder"] = remainder(d);
    out["noise"] = {{"sin_rms_v", number(d.noise.sin_v)},
                    {"cos_rms_v", number(d.noise.cos_v)},
                    {"along_rms_v", number(d.noise.along_v)},
                    {"across_rms_v", number(d.noise.across_v)}};
  }
  ordered_json structure = ordered_json::array();
  for (const Structure &s : d.structure)
    structure.push_back(
        {{"along", along(s)}, {"description", s.description}, {"rms_v", number(s.rms_v)}});
  out["unexplained"] = {{"present", !d.structure.empty()},
                        {"residual_rms_v", number(d.unexplained_rms_v)},
                        {"noise_rms_v", number(d.noise_rms_v)},
                        {"structure", structure}};
  ordered_json invisible = ordered_json::array();
  for (const Invisible &i : d.invisible)
    invisible.push_back({{"cause", i.cause}, {"reason", i.reason}});
  out["not_visible"] = invisible;
  out["failed_checks"] = ordered_json::array();
  for (const FailedCheck &c : d.failed_checks)
    out["failed_checks"].push_back({{"check", c.id}, {"explanation", c.explanation}});
  out["next_experiments"] = ordered_json::array();
  for (const Experiment &e : d.next_experiments) {
    ordered_json next = {{"motion", e.motion},
                         {"temperature", e.temperature},
                         {"duration_s", number(e.duration_s)},
                         {"separates", e.separates},
                         {"expected_nats", number(e.expected_nats)},
                         {"sentence", e.sentence}};
    if (!e.record.empty())
      next["record"] = e.record;
    out["next_experiments"].push_back(std::move(next));
  }
  out["verdict"] = verdict_name(d.verdict);
  if (!d.reason.empty())
    out["reason"] = d.reason;
  return out.dump(1);
}

} // namespace ada
