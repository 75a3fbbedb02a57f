// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <memory>

#include "common/file_roles.h"
#include "common/option_checks.h"
#include "common/print.h"
#include "common/progress.h"
#include "common/simulation_options.h"
#include "common/source_options.h"
#include "common/stop.h"
#include "common/verb.h"

namespace cli {

namespace {

struct EmulateOptions {
  SimulationOptions simulation;
  int port = 0;
  std::string capture;
  double speed = 1;
};

Emulator make_emulator(const EmulateOptions &options) {
  if (options.capture.empty()) {
    const Simulation simulation = make_simulation(options.simulation);
    return make_as_asked<Emulator>(ada4571_emulator_new,
                                   static_cast<const ada4571_simulation *>(simulation.get()),
                                   options.port);
  }
  const Busy busy("reading " + options.capture);
  const auto recording = open_capture(options.capture);
  return make_as_asked<Emulator>(ada4571_emulator_new_replay,
                                 static_cast<const ada4571_recording *>(recording.get()),
                                 options.speed, options.port);
}

int run(const EmulateOptions &options) {
  const Emulator emulator = make_emulator(options);
  const StopSignal stop([&emulator] { ada4571_emulator_stop(emulator.get()); });
  // The address is the result: a script reads it from the first line.
  print("ip:127.0.0.1:{}\n", ada4571_emulator_port(emulator.get()));
  note("serving; Ctrl-C ends it. Try: iio_info -u ip:127.0.0.1:{}\n",
       ada4571_emulator_port(emulator.get()));
  check(ada4571_emulator_run(emulator.get()));
  return kDone;
}

} // namespace

void add_emulate(CLI::App &app, Action &action) {
  auto *verb =
      app.add_subcommand("emulate", "the simulated sensor, or a capture, as a network IIO device for any client");
  auto options = std::make_shared<EmulateOptions>();
  options->simulation.numbers.duration_s = 0; // without end
  add_simulation_options(*verb, options->simulation);
  verb->get_option("--duration")->description("length, in s, 0 for no end");
  add_replay_options(*verb, options->capture, options->speed);
  verb->get_option("--speed")->transform(positive("1")); // a device has a pace
  verb->parse_complete_callback([verb] {
    refuse_beside_capture(*verb, {"--model", "--effect", "--seed", "--motion", "--temperature",
                                  "--rate", "--duration", "--noise", "--bits", "--adc-reference",
                                  "--no-vtemp", "--no-vdd", "--no-reference"});
  });
  verb->add_option("--port", options->port, "TCP port on 127.0.0.1, 0 picks a free one")
      ->capture_default_str()
      ->transform(whole(0, 65535))
      ->type_name("N");
  example(*verb, "  iio-angle emulate --port 30431 --motion constant:rpm=60 &\n"
                 "  iio-angle read -u ip:127.0.0.1:30431\n"
                 "  iio-angle emulate --capture capture.sigmf-meta\n"
                 "The first line of standard output is the URI.");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
