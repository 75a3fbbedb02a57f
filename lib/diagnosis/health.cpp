// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/health.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "base/error.h"
#include "base/robust.h"
#include "calibration/dead_channel.h"
#include "calibration/guards.h"
#include "calibration/single.h"
#include "conversion/frame_converter.h"

namespace ada {

namespace {

/// Isolated samples may be spikes; more, or a row of
/// them, is a fault.
constexpr double kMaxFaultyFraction = 1e-3;
constexpr std::size_t kMaxFaultyRow = 4;
constexpr double kStillFraction = 0.01;  ///< of the supply: less travel is standstill
constexpr double kShortedRatio = 0.05;   ///< travel of VSIN - VCOS over that of the channels
constexpr double kNoiseFactor = 1.5;     ///< measured over stated noise
constexpr double kSupplyTolerance = 0.1; ///< VDD against the stated supply
constexpr std::size_t kFrozenSamples = 200;
constexpr std::size_t kMinNoiseSamples = 100;

/// The model to compare with, and its name.
struct Yardstick {
  Model model;
  std::string name;
  bool states_noise; ///< what was fitted to the capture states no more than the capture shows
};

Yardstick yardstick(const Capture &capture, const Model *model) {
  if (model != nullptr)
    return {*model, "the given calibration", true};
  try {
    const auto estimate = estimate_pair(capture, CalibrationMethod::fit);
    return {model_of(estimate, capture, "check"), "the ellipse that fits this capture", false};
  } catch (const Error &e) {
    if (e.status() != ADA4571_ERROR_UNUSABLE_DATA)
      throw;
  }
  Model nominal;
  nominal.periods_per_turn = capture.meta.periods_per_turn;
  return {nominal.at_supply(capture.meta.supply_v), "a nominal ADA4571 (amplitude 0.29 VDD)",
          false};
}

/// How many samples have a fault, and the longest row of them.
struct Faults {
  std::size_t count = 0, longest = 0, longest_first = 0;
};

Faults count_faults(std::size_t samples, const std::function<bool(std::size_t)> &faulty) {
  Faults faults;
  std::size_t row = 0;
  for (std::size_t i = 0; i < samples; ++i) {
    row = faulty(i) ? row + 1 : 0;
    faults.count += row > 0;
    if (row > faults.longest) {
      faults.longest = row;
      faults.longest_first = i + 1 - row;
    }
  }
  return faults;
}

HealthCheck verdict(std::string id, bool passed, double measured, double limit, std::string unit,
                    std::string explanation) {
  return {std::move(id),   passed ? HealthState::passed : HealthState::failed,
          measured,        limit,
          std::move(unit), std::move(explanation)};
}

HealthCheck cannot_tell(std::string id, std::string why) {
  return {std::move(id), HealthState::unknown, kAbsent, kAbsent, "", std::move(why)};
}

HealthCheck check_bits(const Capture &capture, std::span<const ada4571_angle> angles,
                       std::string id, std::uint32_t bit, double max_fraction, std::size_t max_row,
                       const std::string &fault, const std::string &fine) {
  const Faults faults =
      count_faults(angles.size(), [&](std::size_t i) { return (angles[i].status & bit) != 0; });
  const double fraction = static_cast<double>(faults.count) / static_cast<double>(capture.size());
  const bool passed = fraction <= max_fraction && faults.longest <= max_row;
  return verdict(std::move(id), passed, fraction, max_fraction, "of the samples",
                 passed ? fine
                        : fmt::format("{}: {} samples, the longest row {} from {:.6g} s on", fault,
                                      faults.count, faults.longest,
                                      capture.time_s[faults.longest_first]));
}

HealthCheck check_radius(const Capture &capture, std::span<const ada4571_angle> angles) {
  std::vector<double> radii;
  for (const ada4571_angle &a : angles)
    if (std::isfinite(a.radius))
      radii.push_back(a.radius);
  const double median = quantile(radii, 0.5);
  return check_bits(capture, angles, "radius", ADA4571_SAMPLE_RADIUS, kMaxFaultyFraction,
                    kMaxFaultyRow,
                    fmt::format("the radius leaves its band (median {:.3f}): no magnet, a broken "
                                "wire, or not the sensor of this calibration",
                                median),
                    fmt::format("median {:.4f}, from {:.4f} to {:.4f}", median,
                                quantile(radii, 0.0), quantile(radii, 1.0)));
}

/// First of a row of equal values that noise cannot leave; nothing where the stated noise is below
/// half a step of the converter, so that equal values are ordinary.
std::optional<std::size_t> frozen_from(const Capture &capture, const std::vector<double> &v) {
  const CaptureMetadata &meta = capture.meta;
  if (!meta.noise_rms_v || !meta.adc_bits || !meta.adc_reference_v ||
      *meta.noise_rms_v < 0.5 * *meta.adc_reference_v / std::exp2(*meta.adc_bits))
    return std::nullopt;
  const Faults same =
      count_faults(v.size(), [&v](std::size_t i) { return i > 0 && v[i] == v[i - 1]; });
  if (same.longest < kFrozenSamples)
    return std::nullopt;
  return same.longest_first;
}

HealthCheck check_stuck(const Capture &capture) {
  const double sin_travel = travel(capture.vsin_v), cos_travel = travel(capture.vcos_v);
  const double most = std::max(sin_travel, cos_travel);
  const auto stuck = [&](const char *name, const std::vector<double> &own, double own_travel,
                         const std::vector<double> &other,
                         double other_travel) -> std::optional<HealthCheck> {
    std::optional<std::size_t> first = frozen_from(capture, own);
    if (!first && most >= kStillFraction * capture.meta.supply_v)
      first = own_travel < kStuckRatio * other_travel
                  ? std::size_t{0}
                  : stuck_from(own, own_travel, other, other_travel);
    if (!first)
      return std::nullopt;
    return verdict(
        "stuck", false, own_travel, kStuckRatio * other_travel, "V of travel",
        fmt::format("{} stops following the angle at {:.6g} s", name, capture.time_s[*first]));
  };
  if (auto check = stuck("VSIN", capture.vsin_v, sin_travel, capture.vcos_v, cos_travel))
    return *check;
  if (auto check = stuck("VCOS", capture.vcos_v, cos_travel, capture.vsin_v, sin_travel))
    return *check;
  if (most < kStillFraction * capture.meta.supply_v)
    return cannot_tell("stuck", "the magnet does not turn, so nothing shows whether the channels "
                                "follow it");
  HealthCheck check = verdict("stuck", true, std::min(sin_travel, cos_travel), kAbsent,
                              "V of travel", "both channels follow the magnet");
  return check;
}

HealthCheck check_short(const Capture &capture) {
  const double most = std::max(travel(capture.vsin_v), travel(capture.vcos_v));
  if (most < kStillFraction * capture.meta.supply_v)
    return cannot_tell("short", "the magnet does not turn, so equal channels prove nothing");
  std::vector<double> difference(capture.size());
  std::transform(capture.vsin_v.begin(), capture.vsin_v.end(), capture.vcos_v.begin(),
                 difference.begin(), std::minus<>());
  const double apart = travel(difference) / most;
  const bool always = apart < kShortedRatio;
  const auto first =
      always ? std::optional<std::size_t>(0) : stuck_from(difference, most, capture.vsin_v, most);
  HealthCheck check =
      verdict("short", !first, apart, kAbsent, "of the travel",
              first ? fmt::format("VSIN and VCOS move together from {:.6g} s on: they are shorted",
                                  capture.time_s[*first])
                    : "VSIN and VCOS move apart");
  return check;
}

HealthCheck check_clipping(const Capture &capture) {
  try {
    const EllipseFit fit = fit_ellipse(capture.vsin_v, capture.vcos_v);
    constexpr double whole_turn_deg = 300;
    if (fit.coverage_deg < whole_turn_deg)
      return cannot_tell("clipping", fmt::format("only {:.0f} electrical degrees were covered, so "
                                                 "not every peak was seen",
                                                 fit.coverage_deg));
    refuse_clipped(capture, fit);
  } catch (const Error &e) {
    if (std::string_view(e.what()).find("clipped") == std::string_view::npos)
      return cannot_tell("clipping", e.what());
    return verdict("clipping", false, kAbsent, kAbsent, "", e.what());
  }
  return verdict("clipping", true, kAbsent, kAbsent, "", "the peaks are round");
}

HealthCheck check_gaps(const Capture &capture) {
  const double step = median_step(capture.time_s);
  GapDetector gap;
  std::size_t gaps = 0, backward = 0;
  double lost = 0, longest = 0;
  for (std::size_t i = 0; i < capture.size(); ++i) {
    const bool reported = std::binary_search(capture.gaps.begin(), capture.gaps.end(), i) && i > 0;
    const bool seen = gap(capture.time_s[i]);
    if (i == 0)
      continue;
    const double dt = capture.time_s[i] - capture.time_s[i - 1];
    backward += !(dt > 0);
    if (!seen && !reported)
      continue;
    ++gaps;
    lost += std::max(std::round(dt / step) - 1, 0.0);
    longest = std::max(longest, dt);
  }
  if (backward > 0)
    return verdict("gaps", false, static_cast<double>(backward), 0, "steps back",
                   "time does not grow from sample to sample");
  return verdict("gaps", gaps == 0, static_cast<double>(gaps), 0, "gaps",
                 gaps == 0 ? "no sample is missing"
                           : fmt::format("about {:.0f} samples are missing, the longest gap is "
                                         "{:.6g} s where {:.6g} s is usual",
                                         lost, longest, step));
}

/// Noise of one channel from the third difference of the radius, which no turning and no slow
/// change of amplitude reaches: its variance is 20 times that of white noise. Nothing for too few.
std::optional<double> radial_noise(std::span<const ada4571_angle> angles, double amplitude_v) {
  std::vector<double> third;
  for (std::size_t i = 3; i < angles.size(); ++i) {
    const double d = angles[i].radius - 3 * angles[i - 1].radius + 3 * angles[i - 2].radius -
                     angles[i - 3].radius;
    if (std::isfinite(d))
      third.push_back(d);
  }
  if (third.size() < kMinNoiseSamples)
    return std::nullopt;
  return robust_spread(third) / std::sqrt(20.0) * amplitude_v;
}

HealthCheck check_noise(const Capture &capture, std::span<const ada4571_angle> angles,
                        const Yardstick &reference) {
  const Model model = reference.model.at_supply(capture.meta.supply_v);
  const auto noise = radial_noise(angles, model.baseline.amplitude_v);
  if (!noise)
    return cannot_tell("noise", "too few samples to measure it");
  std::optional<double> stated = capture.meta.noise_rms_v;
  if (!stated && reference.states_noise)
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
  if (capture.meta.adc_bits && capture.meta.adc_reference_v)
    expected = std::hypot(expected, *capture.meta.adc_reference_v /
                                        std::exp2(*capture.meta.adc_bits) / std::sqrt(12.0));
  const double limit = kNoiseFactor * expected;
  return verdict(
      "noise", *noise <= limit, *noise, limit, "V rms",
      fmt::format("{:.3g} mV rms where {:.3g} mV is stated", *noise * 1e3, expected * 1e3));
}

std::optional<HealthCheck> check_supply(const Capture &capture) {
  if (!capture.has_vdd())
    return std::nullopt;
  const double stated = capture.meta.supply_v;
  const double middle = quantile(capture.vdd_v, 0.5);
  const double off = std::abs(middle / stated - 1);
  return verdict("supply", off <= kSupplyTolerance, off, kSupplyTolerance, "of the supply",
                 fmt::format("VDD is {:.3f} V where {:.3f} V is stated", middle, stated));
}

} // namespace

bool Health::sound() const {
  return std::none_of(checks.begin(), checks.end(),
                      [](const HealthCheck &c) { return c.state == HealthState::failed; });
}

Health check_health(const Capture &capture, const Model *model) {
  if (capture.size() == 0)
    throw Error(ADA4571_ERROR_UNUSABLE_DATA, "the capture holds no sample");
  const Yardstick reference = yardstick(capture, model);
  std::vector<ada4571_angle> angles(capture.size());
  FrameConverter(reference.model).capture(capture, angles);

  Health health;
  health.against = reference.name;
  auto &checks = health.checks;
  checks.push_back(check_radius(capture, angles));
  checks.push_back(check_bits(capture, angles, "rails", ADA4571_SAMPLE_RAIL, kMaxFaultyFraction,
                              kMaxFaultyRow, "a channel sits at ground or at VDD",
                              "no channel sits at a rail"));
  checks.push_back(check_clipping(capture));
  checks.push_back(check_stuck(capture));
  checks.push_back(check_short(capture));
  checks.push_back(check_bits(capture, angles, "numbers", ADA4571_SAMPLE_INVALID, 0.0, 0,
                              "samples that are no numbers", "every sample is a number"));
  checks.push_back(check_gaps(capture));
  checks.push_back(check_noise(capture, angles, reference));
  if (auto supply = check_supply(capture))
    checks.push_back(*supply);
  return health;
}

} // namespace ada
