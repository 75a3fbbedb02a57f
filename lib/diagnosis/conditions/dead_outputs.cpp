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
#include "diagnosis/conditions/over_supply.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

constexpr std::size_t kMostLookedAt = 20000; ///< rows that tell a range or a curve

/// A record read from one of its ends.
class FromEnd {
public:
  FromEnd(std::span<const double> sin_v, std::span<const double> cos_v,
          std::span<const char> usable, bool to_end)
      : sin_v_(sin_v), cos_v_(cos_v), usable_(usable), to_end_(to_end) {}
  std::size_t size() const { return sin_v_.size(); }
  std::size_t row(std::size_t k) const { return to_end_ ? size() - 1 - k : k; }
  bool usable(std::size_t k) const { return usable_[row(k)] != 0; }
  double value(int channel, std::size_t k) const {
    return (channel == 0 ? sin_v_ : cos_v_)[row(k)];
  }

private:
  std::span<const double> sin_v_, cos_v_;
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
  std::vector<double> vsin, vcos;
  for (std::size_t k = first; k < rows.size(); k += (rows.size() - first) / kMostLookedAt + 1)
    if (rows.usable(k)) {
      vsin.push_back(rows.value(0, k));
      vcos.push_back(rows.value(1, k));
    }
  try {
    const EllipseFit fit = fit_ellipse(vsin, vcos);
    // Where it was not seen a curve is no curve to be off.
    return fit.coverage_deg >= criteria::kSeenOfCurve ? std::optional(fit.value) : std::nullopt;
  } catch (const Error &) {
    return std::nullopt;
  }
}

struct Standing {
  std::size_t rows = 0, seen = 0; ///< with those left out on the way there; to where it is seen
  double sin_v = 0.0, cos_v = 0.0, off_v = 0.0;
};

std::optional<Standing> standing_off_curve(const FromEnd &rows) {
  const std::size_t n = rows.size();
  const std::size_t end = std::max(criteria::kFewestStanding, n / criteria::kPartStanding);
  if (n < 4 * end)
    return std::nullopt;
  std::size_t usable = 0, stands = 0;
  for (std::size_t k = 0; k < end; ++k)
    usable += rows.usable(k);
  if (2 * usable < end)
    return std::nullopt;
  const std::array<Place, 2> at{place_of(rows, 0, end), place_of(rows, 1, end)};
  std::vector<double> all[2];
  for (std::size_t k = 0; k < n; k += n / kMostLookedAt + 1)
    for (int channel = 0; rows.usable(k) && channel < 2; ++channel)
      all[channel].push_back(rows.value(channel, k));
  const double still_v =
      criteria::kStandsStill * std::max(bulk(all[0]).width(), bulk(all[1]).width());
  if (std::max(at[0].band_v, at[1].band_v) > criteria::kStandsWithin * still_v)
    return std::nullopt;
  const auto stays = [&](int channel, std::size_t k) {
    const Place &p = at[static_cast<std::size_t>(channel)];
    return std::abs(rows.value(channel, k) - p.value_v) <= std::max(p.band_v, still_v);
  };
  while (stands < n && (!rows.usable(stands) || (stays(0, stands) && stays(1, stands))))
    ++stands;
  // A channel that stood by itself while the other one moved is stuck, where that comes to rest
  // later, and does not jump to its place.
  for (const int channel : {0, 1}) {
    constexpr double kMoves = 10.0, kArrives = 3.0; // of what passes for standing
    const int other = 1 - channel;
    const Place &place = at[static_cast<std::size_t>(other)];
    const double standing_v = std::max(place.band_v, still_v);
    std::size_t alone = stands;
    double farthest_v = 0.0;
    for (; alone < n && (!rows.usable(alone) || stays(channel, alone)); ++alone)
      if (rows.usable(alone))
        farthest_v = std::max(farthest_v, std::abs(rows.value(other, alone) - place.value_v));
    if (alone >= stands + end && farthest_v > kMoves * standing_v &&
        std::abs(rows.value(other, stands) - place.value_v) < kArrives * standing_v)
      return std::nullopt;
  }
  if (stands < end || n - stands < end)
    return std::nullopt;
  const auto curve = curve_beyond(rows, stands);
  if (!curve)
    return std::nullopt;
  const EllipseInverse inverse = invert(*curve);
  const auto off = [&](double sin_v, double cos_v) {
    return std::abs(std::hypot(inverse.sine(sin_v, cos_v), inverse.cosine(sin_v, cos_v)) - 1.0);
  };
  Standing out{stands, stands, at[0].value_v, at[1].value_v, 0.0};
  const double there = off(out.sin_v, out.cos_v);
  if (there < criteria::kFarOffCurve)
    return std::nullopt;
  out.off_v = there * curve->amplitude_v;
  // On the way there, too, it is on no curve: until it is as near as all others are.
  std::vector<double> usual;
  for (std::size_t k = stands; k < n; ++k)
    if (rows.usable(k))
      usual.push_back(off(rows.value(0, k), rows.value(1, k)));
  const double near = criteria::kStandsWithin * quantile(std::move(usual), 0.5);
  while (out.seen + end < n && rows.usable(out.seen) &&
         off(rows.value(0, out.seen), rows.value(1, out.seen)) > near)
    ++out.seen;
  // It left before that was seen: it is given as many rows again.
  out.rows = out.seen + std::min(out.seen - stands, n - end - out.seen);
  return out;
}

std::optional<DeadOutputs> dead_outputs(const Capture &c,
                                        const std::optional<PairOfChannels> &steady,
                                        std::span<char> usable, bool to_end) {
  const FromEnd rows(c.vsin_v, c.vcos_v, usable, to_end);
  const auto standing = standing_off_curve(rows);
  // A supply that is recorded takes both outputs with it.
  if (!standing ||
      (steady && !standing_off_curve(FromEnd(steady->sin_v, steady->cos_v, usable, to_end))))
    return std::nullopt;
  for (std::size_t k = 0; k < standing->rows; ++k)
    usable[rows.row(k)] = 0;
  return DeadOutputs{to_end,          c.time_s[rows.row(standing->seen - 1)],
                     standing->sin_v, standing->cos_v,
                     standing->rows,  standing->off_v};
}

} // namespace

std::vector<DeadOutputs> leave_out_dead_outputs(const Capture &capture, std::span<char> usable) {
  std::vector<DeadOutputs> out;
  const std::optional<PairOfChannels> steady = over_supply(capture);
  for (const bool to_end : {true, false})
    if (auto dead = dead_outputs(capture, steady, usable, to_end))
      out.push_back(*dead);
  return out;
}

} // namespace ada
