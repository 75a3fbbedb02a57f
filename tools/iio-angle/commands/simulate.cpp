// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <memory>

#include "common/file_roles.h"
#include "common/option_checks.h"
#include "common/progress.h"
#include "common/simulation_options.h"
#include "common/verb.h"

namespace cli {

namespace {

struct SimulateOptions {
  SimulationOptions simulation;
  std::string output, save_model;
};

int run(const SimulateOptions &options) {
  FileRoles().reads(options.simulation.model).writes(options.output).writes(options.save_model);
  const Simulation simulation = make_simulation(options.simulation);
  Busy busy("simulating");
  const auto capture = make_as_asked<Recording>(ada4571_simulation_run, simulation.get());
  busy.now("writing " + options.output);
  check_usage(ada4571_recording_save(capture.get(), options.output.c_str()));
  if (!options.save_model.empty()) {
    const auto model = make<Model>(ada4571_simulation_model, simulation.get());
    check(ada4571_model_save(model.get(), options.save_model.c_str()));
  }
  return kDone;
}

} // namespace

void add_simulate(CLI::App &app, Action &action) {
  auto *verb = app.add_subcommand("simulate", "a capture from the simulated sensor");
  auto options = std::make_shared<SimulateOptions>();
  add_simulation_options(*verb, options->simulation);
  verb->get_option("--duration")->transform(positive("s")); // a file has an end
  verb->add_option("-o,--output", options->output,
                   "capture file: .csv, .sigmf-meta, or - for standard output")
      ->required()
      ->transform(capture_name())
      ->type_name("CAPTURE");
  verb->add_option("--save-model", options->save_model,
                   "also write the model in force, drawn values included")
      ->transform(ends_in({".toml"}, "a model"))
      ->type_name("FILE");
  example(*verb,
          "  iio-angle simulate --seed 7 --motion constant:rpm=600 --duration 10s -o capture.csv\n"
          "  iio-angle simulate --effect stray-field:b=0.01,direction_deg=30 \\\n"
          "      --effect channel-skew:dt_s=4us --temperature ramp:from=-20,to=100 -o capture.csv");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
