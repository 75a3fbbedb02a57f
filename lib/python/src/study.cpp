// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <vector>

#include <pybind11/stl.h>

#include "call.h"
#include "watcher.h"

namespace binding {

namespace {

using StudyRow = Handle<ada4571_study_row, ada4571_study_row_free>;

Study open_to_write(const std::string &path, bool diagnose) {
  auto o = initialised(ada4571_study_options_init);
  o.diagnose = diagnose;
  return made<Study, ada4571_study>(
      [&](ada4571_study **fresh) { return ada4571_study_open(path.c_str(), &o, fresh); });
}

Study open_to_read(const std::string &path) {
  return made<Study, ada4571_study>(
      [&](ada4571_study **fresh) { return ada4571_study_open(path.c_str(), nullptr, fresh); });
}

std::vector<const char *> bare(const std::vector<std::string> &names) {
  std::vector<const char *> out;
  for (const std::string &name : names)
    out.push_back(name.c_str());
  return out;
}

void list(const Study &study, const std::vector<std::string> &captures) {
  const std::vector<const char *> names = bare(captures);
  call([&] { return ada4571_study_list(study.get(), names.data(), names.size()); }, study);
}

std::vector<std::string> waiting(const Study &study, bool again) {
  size_t count = 0;
  call([&] { return ada4571_study_find_waiting(study.get(), again, &count); }, study);
  std::vector<std::string> out;
  for (size_t k = 0; k < count; ++k)
    out.emplace_back(ada4571_study_waiting(study.get(), k));
  return out;
}

/// The row as text, for put(), and why there is not more in it. `progress` may end it by an
/// exception.
py::tuple analyse(const std::string &capture, bool diagnose,
                  const std::optional<std::string> &reports, const py::object &progress) {
  Watcher watcher(progress);
  auto o = initialised(ada4571_study_options_init);
  o.diagnose = diagnose;
  o.report_folder = or_null(reports);
  o.progress = Watcher::on_progress;
  o.user = &watcher;
  ada4571_study_row *fresh = nullptr;
  const Outcome outcome =
      released([&] { return ada4571_study_analyse(capture.c_str(), &o, &fresh); });
  const StudyRow row(fresh);
  watcher.raise_if_ended();
  check(outcome);
  return py::make_tuple(ada4571_study_row_text(row.get()), ada4571_study_row_reason(row.get()));
}

/// What the library says of a study, as text of its own.
template <auto Function> std::string said(const Study &study) {
  const char *text = "";
  call([&] { return Function(study.get(), &text); }, study);
  return text;
}

void merge(const std::vector<std::string> &parts, const std::string &path) {
  const std::vector<const char *> names = bare(parts);
  call([&] { return ada4571_study_merge(names.data(), names.size(), path.c_str()); });
}

} // namespace

void add_studies(py::module_ &module) {
  py::class_<Study>(module, "Study")
      .def(py::init(&open_to_read))
      .def(py::init(&open_to_write))
      .def("list", list)
      .def("waiting", waiting)
      .def("put",
           [](const Study &study, const std::string &row) {
             call([&] { return ada4571_study_put(study.get(), row.c_str()); }, study);
           })
      .def("json", said<ada4571_study_json>)
      .def("text", said<ada4571_study_text>)
      .def("missing", [](const Study &study) { return ada4571_study_missing(study.get()); })
      .def("report",
           [](const Study &study, const std::string &path) {
             call([&] { return ada4571_study_report(study.get(), path.c_str()); }, study);
           })
      .def("close", [](Study &study) { close(study); });
  module.def("study_analyse", analyse);
  module.def("study_merge", merge);
}

} // namespace binding
