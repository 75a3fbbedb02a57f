// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <memory>
#include <optional>

#include <unistd.h>

#include "common/handles.h"
#include "common/known_names.h"
#include "common/option_checks.h"
#include "common/print.h"
#include "common/stop.h"
#include "common/verb.h"

namespace cli {

namespace {

struct PinsOptions {
  std::string pin, state, stored, line;
  bool active_low = false, hold = false;
};

Pins open_pins(const PinsOptions &options, bool gc) {
  auto wanted = initialised(ada4571_pins_options_init);
  if (!options.stored.empty())
    wanted.config = options.stored.c_str();
  if (!options.line.empty())
    (gc ? wanted.gc_line : wanted.pd_line) = options.line.c_str();
  if (options.active_low)
    (gc ? wanted.gc_active_low : wanted.pd_active_low) = 1;
  const auto open = [&wanted] {
    return make_as_asked<Pins>(ada4571_pins_open,
                               static_cast<const ada4571_pins_options *>(&wanted));
  };
  return options.stored.empty() ? open() : open_stored(options.stored, open);
}

int run(const PinsOptions &options) {
  // Before the line is taken: whoever asks it to end a moment later is to find it listening.
  std::optional<StopSignal> stop;
  if (options.hold && !options.state.empty())
    stop.emplace([] {});
  const bool gc = options.pin == "gc";
  const Pins pins = open_pins(options, gc);
  const ada4571_pin pin = gc ? ADA4571_PIN_GC : ADA4571_PIN_PD;
  if (options.state.empty()) {
    int on = 0;
    check(ada4571_pins_get(pins.get(), pin, &on));
    print("{}\n", on ? "on" : "off");
    return kDone;
  }
  check(ada4571_pins_set(pins.get(), pin, options.state == "on"));
  if (stop) {
    note("{} is {}; Ctrl-C releases the line\n", options.pin, options.state);
    while (!StopSignal::requested())
      usleep(100'000);
  }
  return kDone;
}

} // namespace

void add_pins(CLI::App &app, Action &action) {
  auto *verb =
      app.add_subcommand("pins", "the sensor's GC (gain control) and PD (power down) lines");
  auto options = std::make_shared<PinsOptions>();
  verb->add_option("PIN", options->pin, "gc or pd")->required()->transform(one_of({"gc", "pd"}));
  verb->add_option("STATE", options->state, "on or off; without it the state is printed")
      ->transform(one_of({"on", "off"}));
  verb->add_option("-s,--stored", options->stored, "stored configuration that names the lines")
      ->type_name("NAME");
  verb->add_option("--line", options->line,
                   "line name, or CHIP:OFFSET (default ada4571-gc, ada4571-pd)")
      ->type_name("LINE");
  verb->add_flag("--active-low", options->active_low, "the line is inverted");
  verb->add_flag("--hold", options->hold, "keep the line, and so its state, until Ctrl-C");
  example(*verb,
          "  iio-angle pins gc on\n"
          "  iio-angle pins pd off --line gpiochip0:17 --hold\n"
          "Most drivers keep a line's state after it is released, some do not: --hold is sure.");
  verb->callback([options, &action] { action = [options] { return run(*options); }; });
}

} // namespace cli
