// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <cmath>
#include <memory>

#include "common/file_roles.h"
#include "common/handles.h"
#include "common/jobs.h"
#include "common/option_checks.h"
#include "common/print.h"
#include "common/progress.h"
#include "common/soundness.h"
#include "common/verb.h"

namespace cli {

namespace {

struct CalibrateOptions {
  std::string method = "fit", capture, cold, hot, output;
};

ada4571_calibration_method method_of(const CalibrateOptions &options) {
  return options.method == "mean"      ? ADA4571_CALIBRATE_MEAN
         : options.method == "extrema" ? ADA4571_CALIBRATE_EXTREMA
                                       : ADA4571_CALIBRATE_FIT;
}

void print_effect(const Model &model, std::size_t index) {
  auto effect = initialised(ada4571_effect_info_init);
  check(ada4571_model_effect(model.get(), index, &effect));
  print("{}", effect.id);
  for (std::size_t i = 0; i < effect.parameters; ++i) {
    auto p = initialised(ada4571_parameter_init);
    check(ada4571_model_parameter(model.get(), index, i, &p));
    if (std::isnan(p.value))
      continue;
    print("  {} = {:.6g}", p.name, p.value);
    if (p.std_error > 0)
      print(" +/- {:.2g}", p.std_error);
    if (std::string_view(p.unit) != "1")
      print(" {}", p.unit);
  }
  print("\n");
}

void finish(const Model &model, const std::string &path) {
  check(ada4571_model_save(model.get(), path.c_str()));
  auto baseline = initialised(ada4571_baseline_init);
  check(ada4571_model_get_baseline(model.get(), &baseline));
  print("amplitude  {:.6f} V\noffset_sin {:+.6f} V\noffset_cos {:+.6f} V\n", baseline.amplitude_v,
        baseline.offset_sin_v, baseline.offset_cos_v);
  for (std::size_t i = 0; i < ada4571_model_effect_count(model.get()); ++i)
    print_effect(model, i);
  note("written: {}\n", path);
}

int single(const CalibrateOptions &options) {
  Recording capture;
  Model model;
  {
    Busy busy("reading " + options.capture);
    capture = open_capture(options.capture);
    FileRoles().reads(options.capture, capture).writes(options.output);
    busy.now("calibrating");
    model = make<Model>(ada4571_calibrate_single, capture.get(), method_of(options));
  }
  finish(model, options.output);
  warn_of_faults(capture, options.capture);
  return kDone;
}

double mean_vtemp(const Recording &capture, ada4571_calibration_method method) {
  const auto model = make<Model>(ada4571_calibrate_single, capture.get(), method);
  auto baseline = initialised(ada4571_baseline_init);
  check(ada4571_model_get_baseline(model.get(), &baseline));
  return baseline.vtemp_reference_v;
}

int dual(const CalibrateOptions &options) {
  Recording cold, hot;
  Model model;
  double cold_v = 0, hot_v = 0;
  {
    Busy busy("reading " + options.cold);
    cold = open_capture(options.cold);
    busy.now("reading " + options.hot);
    hot = open_capture(options.hot);
    FileRoles().reads(options.cold, cold).reads(options.hot, hot).writes(options.output);
    busy.now("calibrating");
    model = make<Model>(ada4571_calibrate_dual, cold.get(), hot.get(), method_of(options));
    cold_v = mean_vtemp(cold, method_of(options));
    hot_v = mean_vtemp(hot, method_of(options));
  }
  if (hot_v < cold_v)
    note("{} is the cold capture (VTEMP {:.3f} V), {} the hot one ({:.3f} V): exchanged\n",
         options.hot, hot_v, options.cold, cold_v);
  finish(model, options.output);
  warn_of_faults(cold, options.cold);
  warn_of_faults(hot, options.hot);
  return kDone;
}

void add_common(CLI::App &verb, CalibrateOptions &options) {
  verb.add_option("--method", options.method,
                  "fit: best, needs no whole turn; mean: whole turns; extrema: (max + min)/2 "
                  "(default fit)")
      ->transform(one_of({"fit", "mean", "extrema"}))
      ->type_name("");
  verb.add_option("-o,--output", options.output, "calibration file to write (.toml)")
      ->required()
      ->transform(ends_in({".toml"}, "a calibration"))
      ->type_name("FILE");
  add_jobs_option(verb);
}

} // namespace

void add_calibrate(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("calibrate", "offsets, amplitudes and phase from captures");
  verb->require_subcommand(1);
  auto options = std::make_shared<CalibrateOptions>();

  auto *one = verb->add_subcommand("single", "from a capture at one temperature");
  one->add_option("CAPTURE", options->capture, "the magnet turning, or - for standard input")
      ->type_name("")
      ->required();
  add_common(*one, *options);
  example(*one, "  iio-angle record --duration 10 -o capture.csv     # turn the magnet meanwhile\n"
                "  iio-angle calibrate single capture.csv -o sensor.toml");
  one->callback([options, &action] { action = [options] { return single(*options); }; });

  auto *two = verb->add_subcommand("dual", "from captures at two temperatures, over VTEMP");
  two->add_option("COLD", options->cold, "capture at the lower temperature")
      ->type_name("")
      ->required();
  two->add_option("HOT", options->hot, "capture at the higher temperature")
      ->type_name("")
      ->required();
  add_common(*two, *options);
  example(*two, "  iio-angle calibrate dual 0C.csv 110C.csv -o sensor.toml");
  two->callback([options, &action] { action = [options] { return dual(*options); }; });

  example(*verb, "  iio-angle calibrate single capture.csv -o sensor.toml\n"
                 "  iio-angle calibrate dual cold.csv hot.csv -o sensor.toml");
}

} // namespace cli
