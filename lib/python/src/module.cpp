// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// ada4571._core: the C API for the package's Python files.
#include "call.h"
#include "frames.h"

namespace binding {

void check(const Outcome &outcome) {
  if (outcome.status == ADA4571_OK)
    return;
  const char *name = ada4571_status_name(outcome.status);
  const py::object raise = py::module_::import("ada4571._errors").attr("from_status");
  const py::object error = raise(name, outcome.sentence.empty() ? name : outcome.sentence);
  PyErr_SetObject(py::type::handle_of(error).ptr(), error.ptr());
  throw py::error_already_set();
}

} // namespace binding

PYBIND11_MODULE(_core, module) {
  using namespace binding;
  PYBIND11_NUMPY_DTYPE(ada4571_frame, time_s, vsin_v, vcos_v, vtemp_v, vdd_v, reference_deg);
  PYBIND11_NUMPY_DTYPE(ada4571_angle, time_s, angle_deg, radius, status);
  module.doc() = "The C API of libada4571, as thinly as it goes; use the package ada4571.";
  module.attr("frame_dtype") = py::dtype::of<ada4571_frame>();
  module.attr("angle_dtype") = py::dtype::of<ada4571_angle>();
  module.def("version", [] { return ada4571_version(); });
  module.def("vector_target", [] { return ada4571_vector_target(); });
  module.def("set_jobs", [](unsigned jobs) { ada4571_set_jobs(jobs); });
  add_recordings(module);
  add_imports(module);
  add_models(module);
  add_sources(module);
  add_conversion(module);
  add_simulation(module);
  add_diagnosis(module);
  add_studies(module);
  add_pins(module);
}
