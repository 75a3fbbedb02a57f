// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <cmath>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "capi/guard.h"
#include "capi/handles.h"
#include "capi/long_capture.h"
#include "capi/to_fit.h"
#include "diagnosis/diagnose.h"
#include "diagnosis/words/plausible.h"
#include "recording/join.h"
#include "report/report.h"

using namespace ada;
using namespace ada::capi;

struct ada4571_diagnosis {
  Diagnosis impl;
  std::shared_ptr<const Capture> capture;
  std::string json, text;
};

namespace {

using CapturePtr = std::shared_ptr<const Capture>;

CapturePtr joined(const ada4571_recording *const *recordings, std::size_t count, const char *name,
                  LookedAt &looked_at) {
  require(recordings, name);
  std::vector<CapturePtr> captures;
  for (std::size_t k = 0; k < count; ++k) {
    require(recordings[k], name);
    captures.push_back(looked_at.part_of(*recordings[k]));
  }
  return join(captures);
}

} // namespace

extern "C" {

void ada4571_diagnosis_options_init(ada4571_diagnosis_options *options) {
  if (!options)
    return;
  *options = {};
  options->struct_size = sizeof *options;
}

ada4571_status ada4571_diagnose(const ada4571_recording *recording,
                                const ada4571_diagnosis_options *options,
                                ada4571_diagnosis **diagnosis) {
  return ada4571_diagnose_captures(recording ? &recording : nullptr, 1, options, diagnosis);
}

ada4571_status ada4571_diagnose_captures(const ada4571_recording *const *recordings, size_t count,
                                         const ada4571_diagnosis_options *options,
                                         ada4571_diagnosis **diagnosis) {
  return guard([&] {
    require(recordings, count == 1 ? "recording" : "recordings");
    require(diagnosis, "diagnosis");
    DiagnosisOptions o;
    CapturePtr heldout;
    LookedAt looked_at;
    if (options) {
      require_struct(options, "options");
      if (options->baseline)
        o.baseline = &options->baseline->impl;
      if (options->baseline_name)
        o.baseline_name = options->baseline_name;
      std::vector<const ada4571_recording *> judges;
      if (options->heldout)
        judges.push_back(options->heldout);
      if (options->more_heldout_count > 0)
        require(options->more_heldout, "options.more_heldout");
      for (std::size_t k = 0; k < options->more_heldout_count; ++k)
        judges.push_back(options->more_heldout[k]);
      if (!judges.empty())
        heldout = joined(judges.data(), judges.size(), "options.heldout", looked_at);
      o.heldout = heldout.get();
      if (options->progress)
        o.progress = [options](double fraction, const char *what) {
          if (options->progress(fraction, what, options->user) != 0)
            throw Error(ADA4571_ERROR_STATE, "the diagnosis was stopped");
        };
    }
    auto out = std::make_unique<ada4571_diagnosis>();
    out->capture = joined(recordings, count, "recordings", looked_at);
    if (o.baseline)
      o.baseline->require_periods(out->capture->meta.periods_per_turn,
                                  options->baseline_name ? o.baseline_name : "the model",
                                  "the capture");
    out->impl = diagnose(*out->capture, o);
    for (std::size_t k = 0; k < count; ++k)
      add_checks(out->impl, check_health(to_fit(*recordings[k]), nullptr),
                 count > 1 ? fmt::format("capture {}: ", k + 1) : "");
    out->json = looked_at.with_json(to_json(out->impl));
    out->text = to_text(out->impl) + looked_at.text();
    *diagnosis = out.release();
  });
}

ada4571_verdict ada4571_diagnosis_verdict(const ada4571_diagnosis *diagnosis) {
  return diagnosis ? static_cast<ada4571_verdict>(diagnosis->impl.verdict)
                   : ADA4571_INSUFFICIENT_DATA;
}

const char *ada4571_diagnosis_reference_aside(const ada4571_diagnosis *diagnosis) {
  return diagnosis && !diagnosis->impl.reference_aside.empty()
             ? diagnosis->impl.reference_aside.c_str()
             : nullptr;
}

const char *ada4571_diagnosis_json(const ada4571_diagnosis *diagnosis) {
  return diagnosis ? diagnosis->json.c_str() : "";
}

const char *ada4571_diagnosis_text(const ada4571_diagnosis *diagnosis) {
  return diagnosis ? diagnosis->text.c_str() : "";
}

void ada4571_finding_init(ada4571_finding *finding) {
  if (!finding)
    return;
  *finding = {};
  finding->struct_size = sizeof *finding;
  finding->cause = finding->explanation = finding->separate_by = "";
  finding->angle_error_rms_before_deg = finding->angle_error_rms_after_deg = std::nan("");
}

size_t ada4571_diagnosis_finding_count(const ada4571_diagnosis *diagnosis) {
  return diagnosis ? diagnosis->impl.findings.size() : 0;
}

ada4571_status ada4571_diagnosis_finding(const ada4571_diagnosis *diagnosis, size_t index,
                                         ada4571_finding *finding) {
  return guard([&] {
    require(diagnosis, "diagnosis");
    require_struct(finding, "finding");
    const Finding &f = at(diagnosis->impl.findings, index, "finding");
    const Quality &before = f.before.heldout, &after = f.after.heldout;
    finding->cause = f.effect->info().id.data(); // a literal, so it ends with zero
    finding->explanation = f.explanation.c_str();
    finding->separate_by = f.separate_by.c_str();
    finding->correctable = f.correctable;
    finding->parameters = f.values.size();
    finding->alternatives = f.alternatives.size();
    finding->residual_rms_before_v = before.residual_rms_v;
    finding->residual_rms_after_v = after.residual_rms_v;
    finding->angle_error_rms_before_deg = before.angle_error_rms_deg.value_or(std::nan(""));
    finding->angle_error_rms_after_deg = after.angle_error_rms_deg.value_or(std::nan(""));
    finding->log_likelihood_before = before.log_likelihood;
    finding->log_likelihood_after = after.log_likelihood;
  });
}

ada4571_status ada4571_diagnosis_parameter(const ada4571_diagnosis *diagnosis, size_t finding,
                                           size_t parameter, ada4571_parameter *out) {
  return guard([&] {
    require(diagnosis, "diagnosis");
    require_struct(out, "out");
    const Finding &f = at(diagnosis->impl.findings, finding, "finding");
    const double value = at(f.values, parameter, "parameter");
    const double error =
        parameter < f.std_errors.size() ? f.std_errors[parameter] : std::nan("");
    *out = to_parameter(f.effect->info().parameters[parameter], value, error);
  });
}

const char *ada4571_diagnosis_alternative(const ada4571_diagnosis *diagnosis, size_t finding,
                                          size_t alternative) {
  if (!diagnosis || finding >= diagnosis->impl.findings.size())
    return nullptr;
  const std::vector<std::string> &names = diagnosis->impl.findings[finding].alternatives;
  return alternative < names.size() ? names[alternative].c_str() : nullptr;
}

ada4571_status ada4571_diagnosis_model(const ada4571_diagnosis *diagnosis, ada4571_model **model) {
  return guard([&] {
    require(diagnosis, "diagnosis");
    require(model, "model");
    if (diagnosis->impl.verdict == Verdict::insufficient_data)
      throw Error(ADA4571_ERROR_UNUSABLE_DATA, "no model: " + diagnosis->impl.reason);
    *model = new ada4571_model{diagnosis->impl.extended};
  });
}

ada4571_status ada4571_diagnosis_report(const ada4571_diagnosis *diagnosis, const char *path) {
  return guard([&] {
    require(diagnosis, "diagnosis");
    require(path, "path");
    write_report(diagnosis->impl, *diagnosis->capture, path);
  });
}

void ada4571_diagnosis_free(ada4571_diagnosis *diagnosis) {
  delete diagnosis;
}

} // extern "C"
