// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <vector>

#include <pybind11/stl.h>

#include "frames.h"

namespace binding {

namespace {

Import open_import(const std::string &path, const py::dict &wanted) {
  auto o = initialised(ada4571_import_options_init);
  // Lives until the call is over, as the strings of the options must.
  std::vector<std::string> texts;
  texts.reserve(wanted.size());
  const auto text = [&](const py::handle &value) {
    return value.is_none() ? nullptr : texts.emplace_back(value.cast<std::string>()).c_str();
  };
  o.separator = text(wanted["separator"]);
  o.decimal = text(wanted["decimal"]);
  o.header_lines = wanted["header_lines"].cast<int>();
  o.sample_rate_hz = wanted["sample_rate_hz"].cast<double>();
  o.supply_v = wanted["supply_v"].cast<double>();
  o.periods_per_turn = wanted["periods_per_turn"].cast<int>();
  const std::pair<const char *, ada4571_import_column *> columns[] = {
      {"time", &o.time},   {"vsin", &o.vsin}, {"vcos", &o.vcos},
      {"vtemp", &o.vtemp}, {"vdd", &o.vdd},   {"reference", &o.reference}};
  for (const auto &[key, column] : columns) {
    const auto given = wanted[key].cast<py::tuple>();
    column->column = text(given[0]);
    column->scale = given[1].cast<double>();
    column->offset = given[2].cast<double>();
  }
  return made<Import, ada4571_import>(
      [&](ada4571_import **fresh) { return ada4571_import_open(path.c_str(), &o, fresh); });
}

} // namespace

void add_imports(py::module_ &module) {
  py::class_<Import>(module, "Import")
      .def(py::init(&open_import))
      .def("text", [](const Import &import) { return ada4571_import_text(import.get()); })
      .def("info",
           [](const Import &import) {
             auto i = initialised(ada4571_recording_info_init);
             check(Outcome(ada4571_import_get_info(import.get(), &i)));
             return described(i);
           })
      .def("read",
           [](const Import &import, const py::object &given) {
             Frames frames = as_frames(given);
             ada4571_frame *room = frames.mutable_data();
             const auto capacity = static_cast<std::size_t>(frames.size());
             std::size_t count = 0;
             call([&] { return ada4571_import_read(import.get(), room, capacity, &count); },
                  import);
             return count;
           })
      .def("close", close<Import>);
}

} // namespace binding
