// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <chrono>
#include <memory>
#include <string>

#include <fmt/format.h>

#include "common/file_roles.h"
#include "common/jobs.h"
#include "common/live.h"
#include "common/option_checks.h"
#include "common/progress.h"
#include "common/verb.h"

namespace cli {

namespace {

struct ConvertOptions {
  std::string calibration, capture, output, format;
  bool dynamic = false;
};

/// Shows how far it has come, and how fast it reads.
class Speed {
public:
  explicit Speed(const Recording &capture) {
    auto info = initialised(ada4571_recording_info_init);
    check(ada4571_recording_get_info(capture.get(), &info));
    bytes_ = static_cast<double>(info.samples) * converter_bytes(info);
  }

  static int show(double fraction, const char *what, void *user) {
    static_cast<Speed *>(user)->show(fraction, what);
    return 0;
  }

private:
  using Clock = std::chrono::steady_clock;

  void show(double fraction, const char *what) {
    const double seconds = std::chrono::duration<double>(Clock::now() - began_).count();
    if (progress_.due())
      progress_.show(fraction,
                     fmt::format("{}, {:.0f} MB/s", what, fraction * bytes_ / 1e6 / seconds));
  }

  Progress progress_;
  double bytes_;
  Clock::time_point began_ = Clock::now();
};

ada4571_angle_form form_of(const std::string &format) {
  return format == "csv"     ? ADA4571_ANGLES_TEXT
         : format == "sigmf" ? ADA4571_ANGLES_SIGMF
                             : ADA4571_ANGLES_BY_NAME;
}

/// A name that says nothing of the form would be CSV without a word: who asked for angles.npy or
/// angles.sigmf wants something else.
void require_form(const ConvertOptions &options) {
  const bool sigmf =
      options.output.ends_with(".sigmf-meta") || options.output.ends_with(".sigmf-data");
  if (options.format.empty()) {
    const std::string wrong =
        sigmf ? "" : wrong_ending(options.output, {".csv", ".sigmf-meta"}, "a file of angles");
    if (!wrong.empty())
      throw CLI::ValidationError("--output", wrong + ", or give --format csv");
  } else if (sigmf != (options.format == "sigmf")) {
    throw CLI::ValidationError("--format",
                               fmt::format("{} does not go with the name '{}': that of a "
                                           "SigMF recording ends in .sigmf-meta",
                                           options.format, options.output));
  }
}

int run(const ConvertOptions &options) {
  const ada4571_angle_form form = form_of(options.format);
  const auto model = load_model(options.calibration);
  const auto capture = open_capture(options.capture);
  FileRoles().reads(options.capture, capture).reads(options.calibration).writes(options.output);
  mention_remainder(model);
  Speed speed(capture);
  if (options.dynamic) {
    const auto tracker = make<Tracker>(ada4571_tracker_new, model.get(),
                                       static_cast<const ada4571_tracker_options *>(nullptr));
    check_usage(ada4571_tracker_save(tracker.get(), capture.get(), options.output.c_str(), form,
                                     Speed::show, &speed));
  } else {
    const auto converter = make<Converter>(ada4571_converter_new, model.get());
    check_usage(ada4571_converter_save(converter.get(), capture.get(), options.output.c_str(), form,
                                       Speed::show, &speed));
  }
  return kDone;
}

} // namespace

void add_convert(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("convert", "angles of a capture");
  auto options = std::make_shared<ConvertOptions>();
  verb->add_option("--calibration", options->calibration, "calibration or model file")
      ->required()
      ->type_name("FILE");
  verb->add_flag("--dynamic", options->dynamic, "follow drifting offsets while it turns");
  verb->add_option("CAPTURE", options->capture, "capture file, or - for standard input")
      ->type_name("")
      ->required();
  verb->add_option("-o,--output", options->output,
                   "CSV file with time_s,angle_deg,radius,status, or - for standard output; or "
                   ".sigmf-meta, which is smaller and faster")
      ->required()
      ->type_name("OUT.csv");
  verb->add_option("--format", options->format, "form of the output (default: by its name)")
      ->transform(one_of({"csv", "sigmf"}))
      ->type_name("");
  add_jobs_option(*verb);
  example(*verb,
          "  iio-angle convert --calibration sensor.toml capture.csv -o angles.csv\n"
          "Columns: angle_deg is mechanical, in [0, 360/periods); radius is relative to the\n"
          "calibrated amplitude; status is 0 for a sound sample, else the sum of 1 radius out of\n"
          "its band, 2 at a rail, 4 invalid, 8 samples lost before this one.");
  verb->parse_complete_callback([options] { require_form(*options); });
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
