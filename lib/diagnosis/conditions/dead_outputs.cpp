// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/dead_outputs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/robust.h"
#include "calibration/ellipse_fit.h"
#include "conversion/ellipse.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// A record read from one of its ends.
class FromEnd {
public:
  FromEnd(const Capture &c, std::span<const char> usable, bool to_end)
      : c_(c), usable_(usable), to_end_(to_end) {}
  std::size_t size() const { return c_.size(); }
  std::size_t row(std::size_t k) const { return to_end_ ? size() - 1 - k : k; }
  bool usable(std::size_t k) const { return usable_[row(k)] != 0; }
  double value(int channel, std::size_t k) const {
    return (channel == 0 ? c_.vsin_v : c_.vcos_v)[row(k)];
  }

private:
  const Capture &c_;
  std::span<const char> usable_;
  bool to_end_;
};

struct Place {
  double value_v, band_v;
};

/// Where a channel stands in the first rows from an end, and how far it scatters there.
Place place_of(const FromEnd &rows, int channel, std::size_t first) {
  std::vector<double> v;
  for (std::size_t k = 0; k < first; ++k)
    if (rows.usable(k))
      v.push_back(rows.value(channel, k));
  return {quantile(v, 0.5), criteria::kStandsWithin * robust_spread(v)};
}

std::optional<EllipseParameters> curve_beyond(const FromEnd &rows, std::size_t first) {
  constexpr std::size_t kMost = 20000;
  std::vector<double> vsin, vcos;
  for (std::size_t k = first; k < rows.size(); k += (rows.size() - first) / kMost + 1)
    if (rows.usable(k)) {
      vsin.push_back(rows.value(0, k));
      vcos.push_back(rows.value(1, k));
    }
  try {
    return fit_ellipse(vsin, vcos).value;
  } catch (const Error &) {
    return std::nullopt;
  }
}

std::optional<DeadOutputs> dead_outputs(const Capture &c, std::span<char> usable, bool to_end) {
  const FromEnd rows(c, usable, to_end);
  const std::size_t n = c.size();
  const std::size_t end = std::max(criteria::kFewestStanding, n / criteria::kPartStanding);
  if (n < 4 * end)
    return std::nullopt;
  const std::array<Place, 2> at{place_of(rows, 0, end), place_of(rows, 1, end)};
  const double range_v = std::max(bulk(c.vsin_v).width(), bulk(c.vcos_v).width());
  std::size_t stands = 0;
  const auto is_there = [&](std::size_t k) {
    for (int channel = 0; channel < 2; ++channel) {
      const double off =
          std::abs(rows.value(channel, k) - at[static_cast<std::size_t>(channel)].value_v);
      if (off >
          std::max(at[static_cast<std::size_t>(channel)].band_v, criteria::kStandsStill * range_v))
        return false;
    }
    return true;
  };
  while (stands < n && (!rows.usable(stands) || is_there(stands)))
    ++stands;
  if (at[0].band_v > criteria::kStandsWithin * criteria::kStandsStill * range_v ||
      at[1].band_v > criteria::kStandsWithin * criteria::kStandsStill * range_v || stands < end ||
      n - stands < end)
    return std::nullopt;
  const auto curve = curve_beyond(rows, stands);
  if (!curve)
    return std::nullopt;
  const EllipseInverse inverse = invert(*curve);
  const auto off = [&](double sin_v, double cos_v) {
    return std::abs(std::hypot(inverse.sine(sin_v, cos_v), inverse.cosine(sin_v, cos_v)) - 1.0);
  };
  const double there = off(at[0].value_v, at[1].value_v);
  if (there < criteria::kFarOffCurve)
    return std::nullopt;
  // On the way there, too, it is on no curve: until it is as near as all others are.
  std::vector<double> usual;
  for (std::size_t k = stands; k < n; ++k)
    if (rows.usable(k))
      usual.push_back(off(rows.value(0, k), rows.value(1, k)));
  const double near = criteria::kStandsWithin * quantile(std::move(usual), 0.5);
  const std::size_t still = stands;
  while (stands + end < n && rows.usable(stands) &&
         off(rows.value(0, stands), rows.value(1, stands)) > near)
    ++stands;
  const double at_s = c.time_s[rows.row(stands - 1)];
  // It left before that was seen: it is given as many rows again.
  stands += std::min(stands - still, n - end - stands);
  DeadOutputs out{to_end, at_s, at[0].value_v, at[1].value_v,
                  stands, there * curve->amplitude_v};
  for (std::size_t k = 0; k < stands; ++k)
    usable[rows.row(k)] = 0;
  return out;
}

} // namespace

std::vector<DeadOutputs> leave_out_dead_outputs(const Capture &capture, std::span<char> usable) {
  std::vector<DeadOutputs> out;
  for (const bool to_end : {true, false})
    if (auto dead = dead_outputs(capture, usable, to_end))
      out.push_back(*dead);
  return out;
}

} // namespace ada
