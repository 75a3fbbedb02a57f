// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <pybind11/stl.h>

#include "call.h"

namespace binding {

namespace {

using Text = std::optional<std::string>;

Pins open_pins(const Text &config, const Text &gc_line, const Text &pd_line, bool gc_active_low,
               bool pd_active_low) {
  auto o = initialised(ada4571_pins_options_init);
  o.config = or_null(config);
  o.gc_line = or_null(gc_line);
  o.pd_line = or_null(pd_line);
  o.gc_active_low = gc_active_low;
  o.pd_active_low = pd_active_low;
  return made<Pins, ada4571_pins>([&](ada4571_pins **fresh) { return ada4571_pins_open(&o, fresh); });
}

} // namespace

void add_pins(py::module_ &module) {
  py::class_<Pins>(module, "Pins")
      .def(py::init(&open_pins))
      .def("set",
           [](const Pins &pins, int pin, bool on) {
             call([&] { return ada4571_pins_set(pins.get(), static_cast<ada4571_pin>(pin), on); },
                  pins);
           })
      .def("get",
           [](const Pins &pins, int pin) {
             int on = 0;
             call([&] { return ada4571_pins_get(pins.get(), static_cast<ada4571_pin>(pin), &on); },
                  pins);
             return on != 0;
           })
      .def("close", close<Pins>);
}

} // namespace binding
