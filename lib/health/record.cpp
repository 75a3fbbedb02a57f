// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/angle.h"
#include "base/robust.h"
#include "health/checks.h"
#include "health/criteria.h"
#include "health/spikes.h"

namespace ada::health {

namespace {

std::vector<double> times_of(const Recording &recording, const std::vector<std::size_t> &samples) {
  std::vector<double> times;
  for (std::size_t k = 0; k < samples.size() && times.size() < kMostTimes; ++k)
    if (const double time_s = recording.time_s(samples[k]); std::isfinite(time_s))
      times.push_back(time_s);
  return times;
}

/// "2 in VTEMP (at 0.1 s, 2.5 s)"
std::string spike_text(const Recording &recording, const std::string &where,
                       const std::vector<std::size_t> &samples) {
  std::vector<std::string> at;
  for (std::size_t k = 0; k < std::min(samples.size(), kTimesInText); ++k)
    at.push_back(moment(recording, samples[k]));
  return fmt::format("{} in {} (at {}{})", samples.size(), where, fmt::join(at, ", "),
                     samples.size() > kTimesInText ? ", ..." : "");
}

/// Noise of one channel from the third difference of the radius, which no turning and no slow
/// change of amplitude reaches: its variance is 20 times that of white noise. Nothing for too few.
std::optional<double> radial_noise(const Evidence &e, double amplitude_v) {
  const std::vector<ada4571_angle> &angles = e.angles;
  std::vector<double> third;
  for (std::size_t i = 3; i < angles.size(); ++i) {
    if (e.what.is_long && i % kFirstStretch < 3)
      continue; // not neighbours
    const double d = angles[i].radius - 3 * angles[i - 1].radius + 3 * angles[i - 2].radius -
                     angles[i - 3].radius;
    if (std::isfinite(d))
      third.push_back(d);
  }
  if (third.size() < kMinNoiseSamples)
    return std::nullopt;
  return robust_spread(third) / std::sqrt(20.0) * amplitude_v;
}

} // namespace

HealthCheck check_spikes(const Evidence &e) {
  const Recording &recording = e.what.recording;
  const Tally &t = e.tally;
  std::vector<std::string> parts;
  if (!t.spikes.empty())
    parts.push_back(spike_text(recording, "the pair", t.spikes));
  if (t.disturbing.longest > kMaxFaultyRow)
    parts.push_back(fmt::format("{} of them in a row from {} on", t.disturbing.longest,
                                moment(recording, t.disturbing.longest_first)));
  for (const auto &[name, found] :
       {std::pair("VTEMP", &t.vtemp_spikes), std::pair("VDD", &t.vdd_spikes),
        std::pair("the reference", &t.reference_spikes)})
    if (!found->empty())
      parts.push_back(spike_text(recording, name, *found));
  const bool failed = t.far_are_many || too_many(t.disturbing, recording.size());
  HealthCheck check = verdict(
      "spikes", !failed, static_cast<double>(t.far_are_many ? t.far : t.spikes.size()), kAbsent,
      "samples",
      t.far_are_many
          ? fmt::format("{} samples lie {}, the first at {}: too many to be single ones", t.far,
                        e.ellipse ? fmt::format("off the circle by more than {:g} % of its radius",
                                                100 * kFarOff)
                                  : std::string("beyond the supply"),
                        moment(recording, t.spikes.front()))
      : parts.empty() ? "no sample stands out"
                      : fmt::format("samples that stand out: {}", fmt::join(parts, ", ")));
  check.times_s = times_of(recording, t.spikes);
  return check;
}

HealthCheck check_numbers(const Evidence &e) {
  const std::size_t n = e.what.recording.size();
  const Faults &faults = e.tally.invalid.faults();
  return verdict("numbers", faults.count == 0,
                 static_cast<double>(faults.count) / static_cast<double>(n), 0, "of the samples",
                 faults.count == 0
                     ? "every sample is a number"
                     : fmt::format("{} samples are no numbers, the longest row {} from {} on",
                                   faults.count, faults.longest,
                                   moment(e.what.recording, faults.longest_first)));
}

HealthCheck check_noise(const Evidence &e) {
  const CaptureMetadata &meta = e.capture.meta;
  const Model model = e.yardstick.at_supply(meta.supply_v);
  const auto noise = radial_noise(e, model.baseline.amplitude_v);
  if (!noise)
    return cannot_tell("noise", fmt::format("at least {} samples in a row are needed to measure it",
                                            kMinNoiseSamples + 3));
  std::optional<double> stated = meta.noise_rms_v;
  if (!stated && e.states_noise)
    stated = model.noise_rms_v;
  if (!stated) {
    HealthCheck check = cannot_tell("noise", fmt::format("{:.3g} mV rms; neither capture nor "
                                                         "calibration states what it should be",
                                                         *noise * 1e3));
    check.measured = *noise;
    check.unit = "V rms";
    return check;
  }
  double expected = *stated;
  if (const auto step = stated_step(meta))
    expected = std::hypot(expected, *step / std::sqrt(12.0));
  const double limit = kNoiseFactor * expected;
  return verdict(
      "noise", *noise <= limit, *noise, limit, "V rms",
      fmt::format("{:.3g} mV rms where {:.3g} mV is stated", *noise * 1e3, expected * 1e3));
}

} // namespace ada::health
