// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <memory>

#include "common/file_roles.h"
#include "common/handles.h"
#include "common/jobs.h"
#include "common/print.h"
#include "common/verb.h"

namespace cli {

namespace {

struct CheckOptions {
  std::string calibration, capture;
  bool json = false;
};

int run(const CheckOptions &options) {
  const auto capture = open_capture(options.capture);
  Model model;
  if (!options.calibration.empty())
    model = load_model(options.calibration);
  const auto health =
      make<Health>(ada4571_check, capture.get(), static_cast<const ada4571_model *>(model.get()));
  const std::string_view result =
      options.json ? ada4571_health_json(health.get()) : ada4571_health_text(health.get());
  print("{}{}", result, result.ends_with('\n') ? "" : "\n");
  return ada4571_health_sound(health.get()) ? kDone : kUnusable;
}

} // namespace

void add_check(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand(
      "check", "is the sensor healthy: radius, rails, stuck, spikes, gaps, noise");
  auto options = std::make_shared<CheckOptions>();
  verb->add_option("--calibration", options->calibration,
                   "calibration of this sensor (default: the circle that fits the capture)")
      ->type_name("FILE");
  verb->add_flag("--json", options->json, "print JSON (ada4571-check/1) instead of text");
  verb->add_option("CAPTURE", options->capture, "capture file, or - for standard input")
      ->type_name("")
      ->required();
  add_jobs_option(*verb);
  example(*verb,
          "  iio-angle check --calibration sensor.toml capture.csv\n"
          "Exit status 0 when no check failed, 1 when one did or there are too few samples.");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
