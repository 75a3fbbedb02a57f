// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "study/analyse.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "base/angle.h"
#include "base/error.h"
#include "calibration/single.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/words/plausible.h"
#include "health/health.h"
#include "model/effect.h"
#include "recording/capture_file.h"
#include "recording/metadata.h"
#include "report/report.h"

namespace ada::study {

namespace {

/// What the quick calibration finds counts as found when it is this many standard errors from zero.
constexpr double kFoundSigmas = 4.0;

/// Headers hold a few words each; what is longer is no factor.
constexpr std::size_t kMostFactors = 64, kLongestFactor = 200;

double mean(const std::vector<double> &x) {
  double sum = 0.0;
  for (double v : x)
    sum += v;
  return sum / static_cast<double>(x.size());
}

void read_header(const Capture &c, Row &row) {
  row.identity = c.identity;
  row.serial = c.meta.serial;
  row.has_reference = c.has_reference();
  row.samples = static_cast<std::int64_t>(c.size());
  row.duration_s = c.size() > 0 ? c.time_s.back() - c.time_s.front() : 0.0;
  for (const auto &[key, value] : metadata_entries(c.meta))
    if (key != "serial" && row.factors.size() < kMostFactors && value.size() <= kLongestFactor)
      row.factors.emplace_back(key, value);
  if (c.has_vtemp())
    row.factors.emplace_back("vtemp_mean_v", std::to_string(mean(c.vtemp_v)));
}

Health check(const Capture &c, Row &row) {
  Health health = check_health(c, nullptr);
  row.sound = health.sound();
  for (const HealthCheck &h : health.checks)
    row.checks.push_back({h.id,
                          h.state == HealthState::passed   ? "passed"
                          : h.state == HealthState::failed ? "failed"
                                                           : "unknown",
                          h.measured, h.limit, h.unit});
  return health;
}

double error_of(const std::vector<double> &errors, std::size_t k) {
  return k < errors.size() ? errors[k] : kNaN;
}

void add_parameters(const Effect &effect, const std::vector<double> &values,
                    const std::vector<double> &errors, int place, Row &row) {
  const auto parameters = effect.info().parameters;
  for (std::size_t k = 0; k < parameters.size(); ++k)
    if (std::isfinite(values[k]))
      row.quantities.push_back({place, std::string(effect.info().id),
                                std::string(parameters[k].name), std::string(parameters[k].unit),
                                values[k], error_of(errors, k)});
}

/// The ellipse, which every capture has, found or not, so that its numbers are not only those of
/// the captures where they are large.
Model calibrate(const Capture &c, Row &row) {
  const Model m = calibrate_single(c, CalibrationMethod::fit);
  const Baseline &b = m.baseline, &e = m.baseline_std_error;
  const auto add = [&row](const char *name, double value, double error) {
    row.quantities.push_back({0, kBaseline, name, "V", value, error});
  };
  add("amplitude_v", b.amplitude_v, e.amplitude_v);
  add("offset_sin_v", b.offset_sin_v, e.offset_sin_v);
  add("offset_cos_v", b.offset_cos_v, e.offset_cos_v);
  if (m.noise_rms_v)
    add("noise_rms_v", *m.noise_rms_v, kNaN);
  for (const EffectInstance &i : m.effects)
    add_parameters(*i.effect, i.values, i.std_errors, 0, row);
  return m;
}

/// Without a diagnosis: what the calibration holds, at the angle that it costs.
void findings_of_calibration(const Model &m, Row &row) {
  for (const EffectInstance &i : m.effects) {
    if (i.values.size() != 1 || !(std::abs(i.values[0]) > kFoundSigmas * error_of(i.std_errors, 0)))
      continue;
    const bool degrees = i.effect->info().parameters[0].unit == "deg";
    // Each turns the angle by half its size, as a sine of twice the electrical angle.
    const double size = std::abs(i.values[0]) * (degrees ? 1.0 : kDegPerRad);
    row.findings.push_back({std::string(i.effect->info().id),
                            {},
                            size / (2.0 * std::numbers::sqrt2 * m.periods_per_turn),
                            i.effect->info().correctable});
  }
}

double cost_of(const Finding &f, const Model &m) {
  const Quality &before = f.before.heldout, &after = f.after.heldout;
  if (before.angle_error_rms_deg && after.angle_error_rms_deg) {
    const double b = *before.angle_error_rms_deg, a = *after.angle_error_rms_deg;
    return std::sqrt(std::max(0.0, b * b - a * a));
  }
  return angle_cost_deg(before.residual_rms_v, after.residual_rms_v, m.baseline.amplitude_v,
                        m.periods_per_turn);
}

void diagnose_capture(const Capture &c, const Health &health, const Model &calibration,
                      const AnalysisOptions &options, Row &row) {
  DiagnosisOptions how;
  how.progress = options.progress;
  Diagnosis d = diagnose(c, how);
  add_checks(d, health);
  row.verdict = verdict_name(d.verdict);
  if (d.verdict == Verdict::insufficient_data)
    throw Error(ADA4571_ERROR_UNUSABLE_DATA, row.capture + ": cannot be diagnosed: " + d.reason);
  const Quality &left = d.extended_quality.heldout;
  row.extended_angle_rms_deg = left.angle_error_rms_deg.value_or(kNaN);
  row.quantities.push_back({0, kExtendedModel, "residual_rms_v", "V", left.residual_rms_v, kNaN});
  for (const Finding &f : d.findings) {
    row.findings.push_back(
        {std::string(f.effect->info().id), f.alternatives, cost_of(f, calibration), f.correctable});
    add_parameters(*f.effect, f.values, f.std_errors, static_cast<int>(row.findings.size()), row);
  }
  if (options.report_folder.empty())
    return;
  std::filesystem::create_directories(options.report_folder);
  std::string name = c.identity.empty() ? row.capture : c.identity;
  std::replace_if(
      name.begin(), name.end(), [](char x) { return x == ':' || x == '/'; }, '-');
  const std::string page = options.report_folder + "/" + name + ".html";
  write_report(d, c, page);
  row.report = page;
}

} // namespace

double angle_cost_deg(double before_v, double after_v, double amplitude_v, int periods) {
  const double v = std::sqrt(std::max(0.0, before_v * before_v - after_v * after_v));
  return amplitude_v > 0.0 ? v / amplitude_v / periods * kDegPerRad : kNaN;
}

Row failed_row(const std::string &capture, const std::string &reason) {
  Row row;
  row.capture = capture;
  row.state = RowState::failed;
  row.reason = reason;
  row.program = ADA4571_VERSION_STRING;
  row.extended_angle_rms_deg = kNaN;
  const FileStamp stamp = stamp_of(capture);
  row.bytes = stamp.bytes;
  row.modified_ns = stamp.modified_ns;
  return row;
}

Row analyse(const std::string &capture, const AnalysisOptions &options) {
  // The stamp from before the reading: a file that changes meanwhile is done again.
  Row row = failed_row(capture, "");
  try {
    const Capture c = read_capture(capture);
    read_header(c, row);
    const Health health = check(c, row);
    const Model calibration = calibrate(c, row);
    if (options.diagnose)
      diagnose_capture(c, health, calibration, options, row);
    else
      findings_of_calibration(calibration, row);
    row.signature = signature_of(c);
    row.state = RowState::done;
  } catch (const Stopped &) {
    throw;
  } catch (const std::exception &e) {
    row.reason = e.what();
  }
  return row;
}

} // namespace ada::study
