// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/describe.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/chrono.h>
#include <fmt/format.h>

namespace ada {

void describe_capture(const Capture &capture, const Scene &scene, Diagnosis &d) {
  d.samples = capture.size();
  d.duration_s = capture.size() > 1 ? capture.time_s.back() - capture.time_s.front() : 0.0;
  d.turns = std::isfinite(scene.turns) ? scene.turns : 0.0; // equal times have no speed
  d.periods_per_turn = scene.periods;
  d.channels = {"vsin_v", "vcos_v"};
  if (capture.has_vtemp())
    d.channels.push_back("vtemp_v");
  if (capture.has_vdd())
    d.channels.push_back("vdd_v");
  if (capture.has_reference())
    d.channels.push_back("reference_deg");
  d.has_reference = capture.has_reference();
}

std::string unnamed_sentence(const BudgetLine &line, const Selection &unnamed, const Scene &scene) {
  const double mv = 1e3 * line.unnamed_rms_v;
  switch (line.axis) {
  case Axis::angle:
    return fmt::format("{:.3g} mV rms repeat with the angle, up to order {} of the {}, and no named "
                       "cause explains them",
                       mv, unnamed.orders[static_cast<std::size_t>(line.axis)],
                       in_turns(scene) ? "turn" : "electrical period");
  case Axis::speed:
    return fmt::format("{:.3g} mV rms change with speed or direction, and no named cause explains "
                       "them",
                       mv);
  case Axis::time:
    return fmt::format("{:.3g} mV rms change slowly over the record, and no named cause explains "
                       "them",
                       mv);
  case Axis::frequency:
    return fmt::format("{:.3g} mV rms lie in lines of the spectrum, and no named cause explains "
                       "them",
                       mv);
  default:
    return fmt::format("{:.3g} mV rms change with {}, and no named cause explains them", mv,
                       line.axis == Axis::supply ? "the supply" : "temperature");
  }
}

Provenance provenance_of(const Capture &capture, const Rung &fitted) {
  Provenance p;
  p.serial = capture.meta.serial;
  p.date = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(
                                                    std::chrono::system_clock::now())));
  p.method = "diagnose";
  p.capture_identity = capture.identity;
  p.generator = std::string("libada4571 ") + ADA4571_VERSION_STRING;
  p.gain_control = capture.meta.gain_control;
  p.fit_residual_rms_v = fitted.in_sample.residual_rms_v;
  p.heldout_residual_rms_v = fitted.heldout.residual_rms_v;
  if (capture.has_vtemp()) {
    p.vtemp_min_v = *std::min_element(capture.vtemp_v.begin(), capture.vtemp_v.end());
    p.vtemp_max_v = *std::max_element(capture.vtemp_v.begin(), capture.vtemp_v.end());
  }
  return p;
}

} // namespace ada
