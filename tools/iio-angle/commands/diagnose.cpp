// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <exception>
#include <memory>
#include <set>
#include <string>
#include <vector>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <fmt/ranges.h>

#include "common/file_roles.h"
#include "common/handles.h"
#include "common/jobs.h"
#include "common/option_checks.h"
#include "common/print.h"
#include "common/progress.h"
#include "common/verb.h"

namespace cli {

namespace {

struct DiagnoseOptions {
  std::string model, extend, report;
  std::vector<std::string> heldout, captures;
  bool json = false;
};

int on_progress(double fraction, const char *what, void *user) {
  static_cast<Progress *>(user)->show(fraction, what);
  return 0;
}

/// Recordings of all paths, and their bare pointers for the library.
struct Recordings {
  std::vector<Recording> own;
  std::vector<const ada4571_recording *> bare;
  explicit Recordings(const std::vector<std::string> &paths) {
    for (const std::string &path : paths) {
      own.push_back(open_capture(path));
      bare.push_back(own.back().get());
    }
  }
};

/// A diagnosis takes vectors as long as the capture and gives them back, again and again. Pages
/// that go back to the system each time and come again cost a fifth of its seconds, and no less is
/// held at the most.
void keep_memory() {
#ifdef __GLIBC__
  constexpr int kMiB = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 64 * kMiB);
  mallopt(M_TRIM_THRESHOLD, 256 * kMiB);
#endif
}

Diagnosis diagnose(const DiagnoseOptions &options, const Recordings &captures,
                   const Recordings &heldout) {
  keep_memory();
  Model baseline;
  if (!options.model.empty())
    baseline = load_model(options.model);
  Progress progress;
  auto wanted = initialised(ada4571_diagnosis_options_init);
  wanted.baseline = baseline.get();
  if (baseline)
    wanted.baseline_name = options.model.c_str();
  wanted.more_heldout = heldout.bare.data();
  wanted.more_heldout_count = heldout.bare.size();
  wanted.progress = on_progress;
  wanted.user = &progress;
  return make<Diagnosis>(ada4571_diagnose_captures, captures.bare.data(), captures.bare.size(),
                         static_cast<const ada4571_diagnosis_options *>(&wanted));
}

/// Captures of one call are of one sensor, or so it is taken.
void mention_serials(const Recordings &captures, const Recordings &heldout) {
  std::set<std::string> serials;
  for (const Recordings *some : {&captures, &heldout})
    for (const Recording &recording : some->own) {
      auto info = initialised(ada4571_recording_info_init);
      check(ada4571_recording_get_info(recording.get(), &info));
      // Each simulation counts its own seed for a serial, whatever the model is.
      const std::string serial = info.serial;
      if (!serial.empty() && !serial.starts_with("simulated-"))
        serials.insert(serial);
    }
  if (serials.size() > 1)
    note("the serials differ ({}): the captures are taken for those of one sensor all the same\n",
         fmt::join(serials, ", "));
}

int run(const DiagnoseOptions &options) {
  const Recordings captures(options.captures), heldout(options.heldout);
  mention_serials(captures, heldout);
  FileRoles roles;
  for (std::size_t k = 0; k < captures.own.size(); ++k)
    roles.reads_once(options.captures[k], captures.own[k]);
  for (std::size_t k = 0; k < heldout.own.size(); ++k)
    roles.reads_once(options.heldout[k], heldout.own[k]);
  roles.reads(options.model).writes("-").writes(options.extend).writes(options.report);
  const Diagnosis diagnosis = diagnose(options, captures, heldout);
  const bool told = ada4571_diagnosis_verdict(diagnosis.get()) != ADA4571_INSUFFICIENT_DATA;
  const auto extend = [&] {
    if (options.extend.empty())
      return;
    const auto model = make<Model>(ada4571_diagnosis_model, diagnosis.get());
    check(ada4571_model_save(model.get(), options.extend.c_str()));
  };
  // Before the result, which a reader may cut short; but what becomes of the file does not cost it.
  std::exception_ptr not_written;
  if (told)
    try {
      extend();
    } catch (...) {
      not_written = std::current_exception();
    }
  const std::string_view result = options.json ? ada4571_diagnosis_json(diagnosis.get())
                                               : ada4571_diagnosis_text(diagnosis.get());
  print("{}{}", result, result.ends_with('\n') ? "" : "\n");
  // Last: whatever becomes of the page, the result is out.
  if (!options.report.empty())
    check(ada4571_diagnosis_report(diagnosis.get(), options.report.c_str()));
  if (not_written)
    std::rethrow_exception(not_written);
  if (!told)
    extend(); // there may be no model, and the result has said why
  return told ? kDone : kUnusable;
}

} // namespace

void add_diagnose(CLI::App &app, Action &action) {
  auto *verb =
      app.add_subcommand("diagnose", "what the simulation gets wrong, why, and what is gained");
  auto options = std::make_shared<DiagnoseOptions>();
  verb->add_option("--model", options->model,
                   "model to test (default: the application note's, fitted to the capture)")
      ->type_name("FILE");
  verb->add_option("--heldout", options->heldout,
                   "capture to measure the gain on, may be given again (default: whole turns of "
                   "CAPTURE, or every third of six or more)")
      ->type_name("CAPTURE")
      ->allow_extra_args(false);
  verb->add_option("--extend", options->extend, "write the extended model, ready for convert")
      ->transform(ends_in({".toml"}, "a model"))
      ->type_name("FILE");
  verb->add_flag("--json", options->json, "print JSON (ada4571-diagnosis/1) instead of text");
  verb->add_option("--report", options->report, "write one self-contained HTML page")
      ->transform(ends_in({".html", ".htm"}, "an HTML page"))
      ->type_name("FILE.html");
  verb->add_option("CAPTURE", options->captures,
                   "capture file, or - for standard input; several of one sensor are diagnosed "
                   "together, each with a zero angle of its own")
      ->type_name("...")
      ->required();
  add_jobs_option(*verb);
  example(*verb, "  iio-angle diagnose --report report.html capture.csv\n"
                 "  iio-angle diagnose --json --extend sensor.toml capture.csv\n"
                 "  iio-angle convert --calibration sensor.toml capture.csv -o angles.csv\n"
                 "Exit status 1 also when the capture holds too little to tell by: the result says "
                 "what is missing.");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
