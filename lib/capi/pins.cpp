// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/pins.h"

#include "capi/guard.h"

using namespace ada;
using namespace ada::capi;

struct ada4571_pins {
  Pins impl;
};

namespace {

/// An option wins over the stored configuration, a line together with its polarity.
PinsConfig translate(const ada4571_pins_options &options) {
  PinsConfig pins;
  if (options.config)
    pins = load_config(options.config).pins;
  if (options.gc_line)
    pins.gc = options.gc_line;
  if (options.gc_line || !options.config)
    pins.gc_active_low = options.gc_active_low != 0;
  if (options.pd_line)
    pins.pd = options.pd_line;
  if (options.pd_line || !options.config)
    pins.pd_active_low = options.pd_active_low != 0;
  return pins;
}

Pins::Pin translate(ada4571_pin pin) {
  switch (pin) {
  case ADA4571_PIN_GC:
    return Pins::Pin::gc;
  case ADA4571_PIN_PD:
    return Pins::Pin::pd;
  }
  throw Error(ADA4571_ERROR_INVALID_ARGUMENT, "there is no such pin");
}

} // namespace

extern "C" {

void ada4571_pins_options_init(ada4571_pins_options *options) {
  if (!options)
    return;
  *options = {};
  options->struct_size = sizeof *options;
}

ada4571_status ada4571_pins_open(const ada4571_pins_options *options, ada4571_pins **pins) {
  return guard([&] {
    require_struct(options, "options");
    require(pins, "pins");
    *pins = new ada4571_pins{Pins(make_gpio_chips(), translate(*options))};
  });
}

ada4571_status ada4571_pins_set(ada4571_pins *pins, ada4571_pin pin, int on) {
  return guard([&] {
    require(pins, "pins");
    pins->impl.set(translate(pin), on != 0);
  });
}

ada4571_status ada4571_pins_get(ada4571_pins *pins, ada4571_pin pin, int *on) {
  return guard([&] {
    require(pins, "pins");
    require(on, "on");
    *on = pins->impl.get(translate(pin));
  });
}

void ada4571_pins_free(ada4571_pins *pins) {
  delete pins;
}

} // extern "C"
