// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include <algorithm>
#include <functional>
#include <vector>

#include <pybind11/stl.h>

#include "watcher.h"

namespace binding {

namespace {

using Recordings = std::vector<const Recording *>;
using Handles = std::vector<const ada4571_recording *>;

Handles handles_of(const Recordings &recordings) {
  Handles handles;
  for (const Recording *recording : recordings)
    handles.push_back(recording->get());
  return handles;
}

/// The locks of all, each once, in the order that every thread keeps.
std::vector<std::unique_lock<std::mutex>> locked(Recordings all) {
  std::sort(all.begin(), all.end(), std::less<>());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::vector<std::unique_lock<std::mutex>> locks;
  for (const Recording *recording : all)
    locks.emplace_back(recording->mutex());
  return locks;
}

Diagnosis diagnose(const Recordings &recordings, const Recordings &heldout, const Model *model,
                   const std::optional<std::string> &name, const py::object &progress) {
  const Handles captures = handles_of(recordings), judges = handles_of(heldout);
  Recordings all = recordings;
  all.insert(all.end(), heldout.begin(), heldout.end());
  Watcher watcher(progress);
  auto o = initialised(ada4571_diagnosis_options_init);
  o.baseline = model ? model->get() : nullptr;
  o.baseline_name = or_null(name);
  if (!judges.empty()) {
    o.heldout = judges.front();
    o.more_heldout = judges.data() + 1;
    o.more_heldout_count = judges.size() - 1;
  }
  o.progress = Watcher::on_progress;
  o.user = &watcher;
  ada4571_diagnosis *fresh = nullptr;
  const Outcome outcome = released([&] {
    const auto locks = locked(all);
    return ada4571_diagnose_captures(captures.data(), captures.size(), &o, &fresh);
  });
  Diagnosis diagnosis(fresh);
  watcher.raise_if_ended();
  check(outcome);
  return diagnosis;
}

py::tuple check_health(const Recording &recording, const Model *model) {
  using Health = Handle<ada4571_health, ada4571_health_free>;
  const auto health = made<Health, ada4571_health>(
      [&](ada4571_health **fresh) {
        return ada4571_check(recording.get(), model ? model->get() : nullptr, fresh);
      },
      recording);
  return py::make_tuple(ada4571_health_json(health.get()), ada4571_health_text(health.get()));
}

} // namespace

void add_diagnosis(py::module_ &module) {
  py::class_<Diagnosis>(module, "Diagnosis")
      .def("json", [](const Diagnosis &d) { return ada4571_diagnosis_json(d.get()); })
      .def("text", [](const Diagnosis &d) { return ada4571_diagnosis_text(d.get()); })
      .def("model",
           [](const Diagnosis &d) {
             return made<Model, ada4571_model>(
                 [&](ada4571_model **fresh) { return ada4571_diagnosis_model(d.get(), fresh); }, d);
           })
      .def("report", [](const Diagnosis &d, const std::string &path) {
        call([&] { return ada4571_diagnosis_report(d.get(), path.c_str()); }, d);
      });
  module.def("diagnose", diagnose);
  module.def("check", check_health);
}

} // namespace binding
