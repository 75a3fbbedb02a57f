// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/robust.h"
#include "conversion/sample_status.h"
#include "health/checks.h"
#include "health/criteria.h"
#include "simulation/simulation.h"

namespace ada::health {

namespace {

HealthCheck vtemp_fault(double measured, double limit, std::string unit, std::string explanation) {
  return verdict("vtemp", false, measured, limit, std::move(unit), std::move(explanation));
}

/// Whether one of the places, ascending, is as near as a median of seven tells.
bool beside(const std::vector<std::size_t> &places, std::size_t sample) {
  constexpr std::size_t kNear = 7;
  const auto at = std::lower_bound(places.begin(), places.end(), sample - std::min(sample, kNear));
  return at != places.end() && *at <= sample + kNear;
}

/// Of a column that holds one value only.
HealthCheck constant_vtemp(const Evidence &e, double volts) {
  const auto step = stated_step(e.capture.meta);
  const std::string says = fmt::format("VTEMP is {:.6g} V in every sample", volts);
  if (!step)
    return cannot_tell("vtemp", says +
                                    ": it is not measured, or in steps that are too wide to show "
                                    "its noise");
  if (*step * kFrozenNoiseSteps > kVtempLeastNoise)
    return verdict("vtemp", true, volts, kAbsent, "V", says + ", to the converter's step");
  return vtemp_fault(
      volts, kAbsent, "V",
      fmt::format("{}, where the converter's steps of {:.3g} mV would show its noise: it is "
                  "not connected, or not measured",
                  says, 1e3 * *step));
}

} // namespace

HealthCheck check_vtemp(const Evidence &e) {
  const std::vector<double> &column = e.capture.vtemp_v;
  const Tally &t = e.tally;
  const double supply = e.capture.meta.supply_v, degree_v = kVtempFractionPerDegree * supply;
  const double median = quantile(column, 0.5), noise = noise_between(column);
  const Rails rails(supply);
  if (!(median > rails.low_v && median < rails.high_v))
    return vtemp_fault(
        median, kAbsent, "V",
        fmt::format("VTEMP is {:.3g} V at a supply of {:g} V, where no temperature is: it is "
                    "not connected, shorted, or its scale is wrong",
                    median, supply));
  if (const double limit = kVtempNoiseDeg * degree_v; noise > limit)
    return vtemp_fault(
        noise, limit, "V rms",
        fmt::format("VTEMP scatters by {:.3g} mV rms from sample to sample, {:.3g} degrees "
                    "Celsius: it is not connected, or disturbed",
                    1e3 * noise, noise / degree_v));
  if (t.vtemp_jumps > 0 && beside(t.vtemp_spikes, t.first_vtemp_jump))
    return vtemp_fault(
        static_cast<double>(t.vtemp_jumps), 0, "samples",
        fmt::format(
            "VTEMP is off by more than {:g} degrees Celsius for some samples in a row, first "
            "at {}: a loose contact, or it is disturbed",
            kVtempJumpDeg, moment(e.what.recording, t.first_vtemp_jump)));
  if (t.vtemp_jumps > 0)
    return vtemp_fault(
        static_cast<double>(t.vtemp_jumps), 0, "samples",
        fmt::format("VTEMP jumps by more than {:g} degrees Celsius, first at {}, faster than "
                    "any temperature: two records were joined there, or it is not connected",
                    kVtempJumpDeg, moment(e.what.recording, t.first_vtemp_jump)));
  const std::size_t n = e.what.recording.size(); // a wild sample differs from both beside it
  const auto wild = static_cast<std::size_t>(
      std::max(static_cast<double>(kFewFaulty), kMaxFaultyFraction * static_cast<double>(n)));
  if (n >= kFrozenSamples && t.same_vtemp.faults().count + 2 * wild + 1 >= n)
    return constant_vtemp(e, median);
  return verdict("vtemp", true, noise, kVtempNoiseDeg * degree_v, "V rms",
                 fmt::format("{:.4g} V, {:.2g} mV rms of noise", median, 1e3 * noise));
}

} // namespace ada::health
