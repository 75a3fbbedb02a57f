// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/words/describe.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/conditions/travel.h"
#include "diagnosis/search/step_causes.h"

namespace ada {

void describe_capture(const Capture &capture, const Scene &scene, Diagnosis &d) {
  d.samples = capture.size();
  d.duration_s = capture.size() > 1 ? capture.time_s.back() - capture.time_s.front() : 0.0;
  d.turns = std::isfinite(scene.turns) ? scene.turns : 0.0; // equal times have no speed
  // What the speeds of usable rows add up to leaves out the way over all others.
  if (d.turns > 0.0 && capture.starts.empty())
    d.turns = std::max(d.turns, travel_of(scene.all.alpha) / kTwoPi);
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

std::string unnamed_sentence(const BudgetLine &line, const Selection &unnamed, const Scene &scene,
                             Recurrence again) {
  const double mv = 1e3 * line.unnamed_rms_v;
  switch (line.axis) {
  case Axis::angle:
    return fmt::format(
        "{:.3g} mV rms {} the angle, up to order {} of the {}, and no named cause explains them{}",
        mv, again == Recurrence::seen ? "repeat with" : "go with",
        unnamed.orders[static_cast<std::size_t>(line.axis)],
        in_turns(scene) ? "turn" : "electrical period",
        again == Recurrence::once ? ": too few of these places were seen again"
        : again == Recurrence::untold
            ? ": what was seen twice does not tell the angle from the time"
            : "");
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

std::vector<Structure> unnamed_steps(const Anonymous &unnamed, const Model &model) {
  constexpr double kOfLargest = 0.2; // of a step's own parts, which are worth a word
  const double amplitude = std::abs(model.baseline.amplitude_v);
  const int p = model.periods_per_turn;
  std::vector<Structure> out;
  for (const auto &[moment, offset, pair, mismatch] : steps_of(unnamed, p)) {
    // Of the vector A e^(jx) a part c e^(jx) is gain and angle, c e^(-jx) mismatch and quadrature.
    const double cos_gain = (pair.real() + mismatch.real()) / amplitude;
    const double sin_gain = (pair.real() - mismatch.real()) / amplitude;
    struct Part {
      double volts;
      std::string words;
    };
    std::vector<Part> parts;
    if (std::abs(mismatch.real()) < kOfLargest * std::abs(pair.real()))
      parts.push_back({pair.real(),
                       fmt::format("both amplitudes by {:+.3g} %", 1e2 * pair.real() / amplitude)});
    else {
      parts.push_back({amplitude * sin_gain,
                       fmt::format("the amplitude of VSIN by {:+.3g} %", 1e2 * sin_gain)});
      parts.push_back({amplitude * cos_gain,
                       fmt::format("the amplitude of VCOS by {:+.3g} %", 1e2 * cos_gain)});
    }
    parts.push_back({pair.imag(), fmt::format("the angle by {:+.3g} deg",
                                              pair.imag() / (amplitude * p) * kDegPerRad)});
    parts.push_back({mismatch.imag(), fmt::format("the angle between the channels by {:+.3g} deg",
                                                  2.0 * mismatch.imag() / amplitude * kDegPerRad)});
    parts.push_back(
        {offset.imag(), fmt::format("the offset of VSIN by {:+.3g} mV", 1e3 * offset.imag())});
    parts.push_back(
        {offset.real(), fmt::format("the offset of VCOS by {:+.3g} mV", 1e3 * offset.real())});
    double largest = 0.0, sum = 0.0;
    for (const Part &part : parts) {
      largest = std::max(largest, std::abs(part.volts));
      sum += part.volts * part.volts;
    }
    std::erase_if(parts,
                  [&](const Part &part) { return std::abs(part.volts) < kOfLargest * largest; });
    std::stable_sort(parts.begin(), parts.end(), [](const Part &a, const Part &b) {
      return std::abs(a.volts) > std::abs(b.volts);
    });
    std::vector<std::string> words;
    for (const Part &part : parts)
      words.push_back(part.words);
    out.push_back(
        {std::string(axis_name(Axis::time)),
         fmt::format("at {:.6g} s the pair changes at once, and stays so: {}; no named cause "
                     "explains it",
                     moment, fmt::join(words, ", ")),
         std::sqrt(sum / 8.0)}); // of plus and minus a half, in one of two channels
  }
  return out;
}

Provenance provenance_of(const Capture &capture, const SplitQuality &fitted) {
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
    const Reach believed = fence(capture.vtemp_v); // a wild reading is no temperature
    Reach seen{believed.high, believed.low};
    for (const double v : capture.vtemp_v)
      if (believed.holds(v))
        seen = {std::min(seen.low, v), std::max(seen.high, v)};
    if (seen.low <= seen.high) {
      p.vtemp_min_v = seen.low;
      p.vtemp_max_v = seen.high;
    }
  }
  return p;
}

} // namespace ada
