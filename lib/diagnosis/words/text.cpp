// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <fmt/format.h>

#include "base/plain_numbers.h"
#include "base/text.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/words/explain.h"

namespace ada {

namespace {

std::string verdict_sentence(const Diagnosis &d) {
  const char *causes = d.findings.empty() ? "The causes that the model names" : "The causes above";
  switch (d.verdict) {
  case Verdict::no_discrepancy:
    return "The model describes this capture down to its noise: no discrepancy.";
  case Verdict::explained:
    return d.findings.empty() ? fmt::format("{} explain this capture down to its noise.", causes)
                              : "What the model got wrong is explained by the causes above.";
  case Verdict::partly_explained:
    return fmt::format("{} explain a part; something else is left that nothing known explains.",
                       causes);
  case Verdict::unexplained:
    return "The model is wrong here, and nothing known explains how.";
  case Verdict::insufficient_data:
    break;
  }
  return "Not enough data: " + d.reason + ".";
}

std::string error_of(const Quality &q) {
  return q.angle_error_rms_deg ? fmt::format(", angle error {:.4f} deg rms", *q.angle_error_rms_deg)
                               : std::string();
}

std::string failed_checks(const Diagnosis &d) {
  std::string out = d.failed_checks.empty() ? "" : "\nThe capture is not sound:\n";
  for (const FailedCheck &c : d.failed_checks)
    out += fmt::format("  {}: {}\n", c.id, printable(c.explanation));
  return out;
}

} // namespace

std::string to_text(const Diagnosis &d) {
  std::string out =
      fmt::format("{} samples, {:.4g} s, {:.4g} turns, {}\n", d.samples, d.duration_s, d.turns,
                  !d.has_reference   ? "no reference"
                  : d.by_reference() ? "with a reference"
                                     : "with a reference that is set aside");
  if (!d.reference_aside.empty())
    out += fmt::format("the pair is judged by itself: {}\n", d.reference_aside);
  if (d.rows_a_reading > 1.0)
    out += fmt::format("{} is held for {:.3g} rows: the first of them is read\n",
                       d.held_reference ? "the reference" : "each pair", d.rows_a_reading);
  if (d.readings_a_stop > 1.0)
    out += fmt::format("the shaft stops for {:.3g} readings, which have one error: their mean is "
                       "read; along the curve residuals weigh by their own scatter\n",
                       d.readings_a_stop);
  if (d.verdict == Verdict::insufficient_data)
    return in_plain_numbers(out + verdict_sentence(d)) + "\n" + failed_checks(d);
  const Quality &base = d.baseline_quality.heldout;
  out += fmt::format("model: {}: residual {:.4g} mV rms on held-out data{}\n",
                     printable(d.baseline_name), 1e3 * base.residual_rms_v, error_of(base));
  int n = 0;
  for (const Finding &f : d.findings) {
    const Quality &before = f.before.heldout, &after = f.after.heldout;
    out += fmt::format("\n{}. {}\n   {}\n", ++n, f.effect->info().id, f.explanation);
    if (before.residual_rms_v != after.residual_rms_v)
      out += fmt::format("   held-out residual {:.4g} -> {:.4g} mV rms",
                         1e3 * before.residual_rms_v, 1e3 * after.residual_rms_v);
    else if (before.log_likelihood != after.log_likelihood)
      out += fmt::format("   held-out log likelihood {:.4f} -> {:.4f} a sample",
                         before.log_likelihood, after.log_likelihood);
    else
      out += "   shown by the readings themselves";
    if (before.angle_error_rms_deg && after.angle_error_rms_deg)
      out += fmt::format(", angle error {:.4f} -> {:.4f} deg rms", *before.angle_error_rms_deg,
                         *after.angle_error_rms_deg);
    Baseline left;
    out += f.correctable ? "\n"
           : f.effect->leaves_behind(f.values, left)
               ? "\n   the angle is corrected for what it left behind, as it is after the capture\n"
               : "\n   not a matter for the angle: it is never corrected there\n";
    if (!f.alternatives.empty())
      out += fmt::format("   this data cannot tell it from: {}\n   what would: {}\n",
                         fmt::join(f.alternatives, ", "), f.separate_by);
  }
  const Quality &rest = d.extended_quality.heldout;
  // Where the angle is the pair's own nothing is left across the vector.
  out += fmt::format(
      "\nextended model: residual {:.4g} mV rms on held-out data{}{}; noise {:.4g} mV{}\n",
      1e3 * rest.residual_rms_v, d.radius_only ? ", along the vector alone" : "", error_of(rest),
      1e3 * d.noise_rms_v, d.radius_only ? " along it and across" : "");
  for (const Structure &s : d.structure)
    out += fmt::format("left over along {}: {}\n", s.along, s.description);
  out += verdict_sentence(d) + "\n";
  if (!d.next_experiments.empty())
    out += "\nRecord next:\n";
  for (const Experiment &e : d.next_experiments)
    out += fmt::format("  {}\n", e.sentence);
  if (!d.invisible.empty()) {
    out += "\nThis capture cannot show:\n";
    for (const Invisible &i : d.invisible)
      out += fmt::format("  {} ({})\n", i.cause, i.reason);
  }
  return in_plain_numbers(out) + failed_checks(d);
}

} // namespace ada
