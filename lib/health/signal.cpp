// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/robust.h"
#include "conversion/sample_status.h"
#include "health/checks.h"
#include "health/criteria.h"

namespace ada::health {

namespace {

/// A check of single samples: what is wrong with them, and what is said of a capture without.
HealthCheck check_samples(const Evidence &e, std::string id, const Faults &faults,
                          const std::string &fault, const std::string &fine) {
  const std::size_t n = e.what.recording.size();
  const double fraction = static_cast<double>(faults.count) / static_cast<double>(n);
  const bool failed = too_many(faults, n);
  return verdict(std::move(id), !failed, fraction, kMaxFaultyFraction, "of the samples",
                 failed ? fmt::format("{}: {} samples, the longest row {} from {} on", fault,
                                      faults.count, faults.longest,
                                      moment(e.what.recording, faults.longest_first))
                        : fine);
}

/// What a sentence of all samples does not hold for; nothing where it holds for all.
std::string but_for(const Faults &faults) {
  return faults.count == 0   ? std::string()
         : faults.count == 1 ? std::string(" but for a single sample")
                             : fmt::format(" but for {} samples", faults.count);
}

/// "is 3 V", "goes from 1 to 3 V"
std::string span_text(const Reach &bulk) {
  return bulk.width() > 0 ? fmt::format("goes from {:.6g} to {:.6g} V", bulk.low, bulk.high)
                          : fmt::format("is {:.6g} V", bulk.low);
}

/// Distance of the bulk of a channel beyond a range, volts.
double beyond(const Reach &bulk, const Reach &range) {
  return std::max({0.0, bulk.high - range.high, range.low - bulk.low});
}

/// How many different numbers a column holds, but for as many as may be wild.
double different_values(std::vector<double> column) {
  std::erase_if(column, [](double v) { return !std::isfinite(v); });
  const double wild = std::max(static_cast<double>(kFewFaulty),
                               kMaxFaultyFraction * static_cast<double>(column.size()));
  std::sort(column.begin(), column.end());
  const auto end = std::unique(column.begin(), column.end());
  return std::max(static_cast<double>(end - column.begin()) - wild, 0.0);
}

} // namespace

HealthCheck check_range(const Evidence &e) {
  const CaptureMetadata &meta = e.capture.meta;
  for (const auto &[name, column] :
       {std::pair("VSIN", &e.capture.vsin_v), std::pair("VCOS", &e.capture.vcos_v)})
    if (const double codes = meta.adc_bits ? kCodesOverBits * std::exp2(*meta.adc_bits) : kAbsent;
        different_values(*column) > codes)
      return verdict(
          "range", false, different_values(*column), codes, "values",
          fmt::format("{} takes about {:.0f} different values, which a converter of {:g} "
                      "bits cannot give: adc_bits is wrong",
                      name, different_values(*column), *meta.adc_bits));
  const auto widened = [](double low, double high) {
    const double margin = kRangeMargin * (high - low);
    return Reach{low - margin, high + margin};
  };
  const Reach supply = widened(0, meta.supply_v);
  double worst = 0;
  for (const auto &[name, column] :
       {std::pair("VSIN", &e.capture.vsin_v), std::pair("VCOS", &e.capture.vcos_v)}) {
    const Reach seen = bulk(*column);
    if (meta.adc_reference_v) // bipolar converters go as far below ground
      if (const double off = beyond(seen, widened(-*meta.adc_reference_v, *meta.adc_reference_v));
          off > 0)
        return verdict("range", false, off, 0, "V beyond",
                       fmt::format("{} {}, which a converter of {:g} V full scale cannot give: "
                                   "adc_reference_v or the scale is wrong",
                                   name, span_text(seen), *meta.adc_reference_v));
    const double off = beyond(seen, supply);
    worst = std::max(worst, off);
    if (off > 0)
      return verdict(
          "range", false, off, 0, "V beyond",
          fmt::format("{} {}, which no output does at a supply of {:g} V: supply_v or the "
                      "scale is wrong",
                      name, span_text(seen), meta.supply_v));
  }
  return verdict("range", true, worst, 0, "V beyond",
                 fmt::format("both channels stay within the supply of {:g} V{}", meta.supply_v,
                             but_for(e.tally.beyond.faults())));
}

HealthCheck check_radius(const Evidence &e) {
  std::vector<double> radii;
  const std::vector<std::size_t> &spikes = e.tally.spikes;
  for (std::size_t i = 0; i < e.angles.size(); ++i)
    if (std::isfinite(e.angles[i].radius) &&
        !std::binary_search(spikes.begin(), spikes.end(), e.what.place(i)))
      radii.push_back(e.angles[i].radius);
  const double median = quantile(std::move(radii), 0.5);
  const bool any = e.tally.least_radius <= e.tally.greatest_radius;
  return check_samples(
      e, "radius", e.tally.radius.faults(),
      fmt::format(
          "the radius leaves its band, with a median of {:.3f} times that of {}: {}", median,
          e.yardstick_name,
          median < kRadiusMin || median > kRadiusMax
              ? "no magnet, a broken wire, or another sensor"
              : "for a while the magnet is elsewhere, another field adds to it, or a wire is open"),
      fmt::format("median {:.4f}, from {:.4f} to {:.4f}{}", median,
                  any ? e.tally.least_radius : 0.0, any ? e.tally.greatest_radius : 0.0,
                  spikes.empty() ? "" : " but for the spikes"));
}

HealthCheck check_rails(const Evidence &e) {
  return check_samples(e, "rails", e.tally.rails.faults(), "a channel sits at ground or at VDD",
                       "no channel sits at a rail" + but_for(e.tally.rails.faults()));
}

HealthCheck check_amplitude(const Evidence &e) {
  if (const std::string why = no_figures(e); !why.empty())
    return cannot_tell("amplitude", why);
  const double amplitude = e.ellipse->value.amplitude_v;
  const double least = kLeastAmplitude * e.capture.meta.supply_v;
  const std::string text = fmt::format("{:.4g} V", amplitude);
  return verdict(
      "amplitude", amplitude >= least, amplitude, kAbsent, "V",
      amplitude >= least
          ? text
          : fmt::format("{}, less than a bare bridge without amplifier gives at a supply "
                        "of {:g} V ({:.3g} V): supply_v or the scale is wrong, or the "
                        "signal comes from elsewhere",
                        text, e.capture.meta.supply_v, least));
}

HealthCheck check_supply(const Evidence &e) {
  const double stated = e.capture.meta.supply_v;
  const auto judged = [&](double volts, const std::string &text) {
    const double off = std::abs(volts / stated - 1);
    return verdict("supply", off <= kSupplyTolerance, off, kSupplyTolerance, "of the supply", text);
  };
  std::optional<HealthCheck> measured;
  if (e.capture.has_vdd()) {
    const double vdd = quantile(e.capture.vdd_v, 0.5);
    measured = judged(vdd, fmt::format("VDD is {:.3f} V where {:.3f} V is stated", vdd, stated));
  }
  std::string why = no_figures(e);
  if (why.empty() && e.ellipse->coverage_deg < kLeastArcDeg)
    why = fmt::format("only {:.0f} electrical degrees were covered, so where the middle is, is not "
                      "known",
                      e.ellipse->coverage_deg);
  if (measured && (measured->state == HealthState::failed || !why.empty()))
    return *measured;
  if (!why.empty())
    return cannot_tell("supply", "VDD is not recorded, and " + why);
  const EllipseParameters &c = e.ellipse->value;
  const double middle = 0.5 * (c.centre_sin_v + c.centre_cos_v);
  const HealthCheck seen =
      judged(2 * middle, fmt::format("the middle of the signals is {:.3f} V where half of the "
                                     "stated supply is {:.3f} V",
                                     middle, 0.5 * stated));
  return measured && seen.state == HealthState::passed ? *measured : seen;
}

} // namespace ada::health
