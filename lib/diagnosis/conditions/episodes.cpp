// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/episodes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "base/angle.h"
#include "base/error.h"
#include "base/robust.h"
#include "calibration/ellipse_fit.h"
#include "conversion/ellipse.h"
#include "diagnosis/conditions/over_supply.h"
#include "diagnosis/criteria.h"
#include "health/criteria.h"
#include "health/wrong_stretches.h"

namespace ada {

namespace {

constexpr double kOffCurve = 8.0; ///< robust standard deviations, as a spike is
/// Rows that are compared with what is at their place in other turns. With more of them they are at
/// many places.
constexpr std::size_t kMostCompared = 1000;

struct Pair {
  std::span<const double> sin_v, cos_v;
};

/// The ellipse that the bulk of the samples draws.
std::optional<EllipseParameters> curve_of(const Pair &pair, std::span<const char> usable) {
  constexpr std::size_t kMost = 20000;
  std::vector<double> vsin, vcos;
  const std::size_t n = pair.sin_v.size();
  for (std::size_t i = 0; i < n; i += n / kMost + 1)
    if (usable[i]) {
      vsin.push_back(pair.sin_v[i]);
      vcos.push_back(pair.cos_v[i]);
    }
  try {
    return fit_ellipse(vsin, vcos).value;
  } catch (const Error &) {
    return std::nullopt;
  }
}

/// How far the pair is off: along the radius, relative to it, and beside a reference in angle, rad.
struct Off {
  std::vector<double> psi, along, across;
};

Off off_curve(const Capture &c, const Pair &pair, const EllipseParameters &curve,
              std::span<const char> usable) {
  const EllipseInverse inverse = invert(curve);
  const std::size_t n = c.size();
  Off out{std::vector<double>(n), std::vector<double>(n), std::vector<double>(n)};
  for (std::size_t i = 0; i < n; ++i) {
    const double sine = inverse.sine(pair.sin_v[i], pair.cos_v[i]);
    const double cosine = inverse.cosine(pair.sin_v[i], pair.cos_v[i]);
    if (!usable[i] || !std::isfinite(sine) || !std::isfinite(cosine))
      continue;
    out.psi[i] = std::atan2(sine, cosine);
    out.along[i] = std::hypot(sine, cosine) - 1.0;
  }
  if (!c.has_reference())
    return out;
  // In either sense: a swapped pair turns against its reference.
  std::complex<double> with, against;
  const auto reference = [&](std::size_t i) {
    return c.meta.periods_per_turn * c.reference_deg[i] * kRadPerDeg;
  };
  for (std::size_t i = 0; i < n; ++i) {
    with += std::polar(1.0, out.psi[i] - reference(i));
    against += std::polar(1.0, out.psi[i] + reference(i));
  }
  const double sense = std::abs(with) >= std::abs(against) ? 1.0 : -1.0;
  const double zero = std::arg(sense > 0.0 ? with : against);
  for (std::size_t i = 0; i < n; ++i)
    out.across[i] =
        usable[i] ? wrap_centred(out.psi[i] - sense * reference(i) - zero, kTwoPi) : 0.0;
  const double middle = quantile(out.across, 0.5);
  for (double &by : out.across)
    by -= middle;
  return out;
}

/// More samples than single outliers have.
constexpr std::size_t kFewestOfEpisode = health::kMaxFaultyRow + 1;

/// Rows in which a column is off by more than a limit, in so many samples at least: each with what
/// still belongs to it on either side.
std::vector<RowRange> rows_of(const std::vector<double> &by, double spread,
                              std::size_t fewest = kFewestOfEpisode) {
  constexpr std::size_t kBeside = 2;
  constexpr double kBack = 3.0; // standard deviations
  const double limit = std::max(health::kFarOff, kOffCurve * spread);
  const auto off = [&](std::size_t i) { return std::abs(by[i]) > limit; };
  std::vector<RowRange> rows;
  for (std::size_t i = 0; i < by.size(); ++i) {
    if (!off(i))
      continue;
    if (!rows.empty() && i <= rows.back().end + kBeside)
      rows.back().end = i + 1;
    else
      rows.push_back({i, i + 1});
  }
  std::erase_if(rows, [&](const RowRange &r) {
    std::size_t count = 0;
    for (std::size_t i = r.first; i < r.end; ++i)
      count += off(i) ? 1 : 0;
    return count < fewest;
  });
  for (RowRange &r : rows) {
    while (r.first > 0 && std::abs(by[r.first - 1]) > kBack * spread)
      --r.first;
    while (r.end < by.size() && std::abs(by[r.end]) > kBack * spread)
      ++r.end;
    r.first -= std::min(r.first, kBeside);
    r.end = std::min(r.end + kBeside, by.size());
  }
  return rows;
}

/// Whether a row begins or ends at once: what follows the speed or the load does neither.
bool is_abrupt(const std::vector<double> &by, const RowRange &r) {
  constexpr std::size_t kSteps = 3;
  constexpr double kOfWorst = 0.5;
  double worst = 0.0, step = 0.0;
  for (std::size_t i = r.first; i < r.end; ++i) {
    worst = std::max(worst, std::abs(by[i]));
    if (i >= r.first + kSteps)
      step = std::max(step, std::abs(by[i] - by[i - kSteps]));
  }
  return step > kOfWorst * worst;
}

/// In their order; what overlaps is one row.
std::vector<RowRange> joined(std::vector<RowRange> rows, const std::vector<RowRange> &more) {
  rows.insert(rows.end(), more.begin(), more.end());
  std::sort(rows.begin(), rows.end(),
            [](const RowRange &a, const RowRange &b) { return a.first < b.first; });
  std::vector<RowRange> out;
  for (const RowRange &r : rows)
    if (!out.empty() && r.first <= out.back().end)
      out.back().end = std::max(out.back().end, r.end);
    else
      out.push_back(r);
  return out;
}

/// Whether the rows come wherever the vector points. `psi` within a row is taken on the line
/// between its ends. Where the signal itself leaves the ellipse at an angle, it does so whenever it
/// passes.
bool come_at_any_angle(const std::vector<RowRange> &rows, const std::vector<double> &psi) {
  constexpr std::size_t kSectors = 36;
  constexpr double kOften = 0.25; // of the samples of a sector
  std::array<double, kSectors> off{}, all{};
  const auto sector = [](double angle) {
    return std::min(kSectors - 1,
                    static_cast<std::size_t>(wrap(angle, kTwoPi) / kTwoPi * kSectors));
  };
  for (double angle : psi)
    all[sector(angle)] += 1.0;
  for (const RowRange &r : rows) {
    const double from = psi[r.first - 1], way = wrap_centred(psi[r.end] - from, kTwoPi);
    for (std::size_t i = r.first; i < r.end; ++i) {
      const double part =
          static_cast<double>(i - r.first + 1) / static_cast<double>(r.end - r.first + 1);
      all[sector(psi[i])] -= 1.0;
      off[sector(from + part * way)] += 1.0;
    }
  }
  for (std::size_t k = 0; k < kSectors; ++k)
    if (off[k] > kOften * (off[k] + std::max(all[k], 0.0)))
      return false;
  return true;
}

/// Mechanical angle of each sample, unwrapped: of the reference, or of the pair without one.
std::vector<double> way_of(const Capture &c, const std::vector<double> &psi) {
  const double period = c.has_reference() ? 360.0 : kTwoPi;
  const double scale =
      c.has_reference() ? kRadPerDeg : 1.0 / static_cast<double>(c.meta.periods_per_turn);
  std::vector<double> out = c.has_reference() ? c.reference_deg : psi;
  double last = 0.0;
  for (double &a : out) // a gap stands where it was
    last = a = std::isfinite(a) ? a + period * std::round((last - a) / period) : last;
  for (double &a : out)
    a *= scale;
  return out;
}

/// Samples in the order of their place in the turn.
class Places {
public:
  explicit Places(const std::vector<double> &way) : way_(way) {
    for (std::size_t i = 0; i < way.size(); ++i)
      by_place_.emplace_back(wrap(way[i], kTwoPi), static_cast<std::uint32_t>(i));
    std::sort(by_place_.begin(), by_place_.end());
  }

  /// Whether at most other passes of the place of a row the pair is off to the same side, by half
  /// of what it is there at the worst.
  bool recurs(const RowRange &r, const std::vector<double> &by) const {
    const auto larger = [](double a, double b) { return std::abs(a) < std::abs(b); };
    const double worst = *std::max_element(by.begin() + static_cast<std::ptrdiff_t>(r.first),
                                           by.begin() + static_cast<std::ptrdiff_t>(r.end), larger);
    std::size_t passes = 0, off = 0;
    const std::vector<std::uint32_t> there = samples_about(r);
    for (std::size_t k = 0; k < there.size();) {
      bool any = false, own = false;
      const std::size_t first = k;
      for (; k < there.size() && same_pass(there[first], there[k]); ++k) {
        any = any || by[there[k]] * worst > kAlike * worst * worst;
        own = own || (there[k] >= r.first && there[k] < r.end);
      }
      passes += own ? 0 : 1;
      off += !own && any ? 1 : 0;
    }
    return 2 * off > passes;
  }

private:
  static constexpr double kAlike = 0.5;

  bool same_pass(std::size_t a, std::size_t b) const {
    return std::abs(way_[a] - way_[b]) < 0.5 * kTwoPi;
  }

  /// In order of time, those that stand where the row does, in any turn.
  std::vector<std::uint32_t> samples_about(const RowRange &r) const {
    const auto [low, high] =
        std::minmax_element(way_.begin() + static_cast<std::ptrdiff_t>(r.first),
                            way_.begin() + static_cast<std::ptrdiff_t>(r.end));
    std::vector<std::uint32_t> out;
    const double width = std::min(*high - *low, kTwoPi);
    const auto add = [&](double from, double to) {
      for (auto at = std::lower_bound(by_place_.begin(), by_place_.end(), std::pair(from, 0u));
           at != by_place_.end() && at->first <= to; ++at)
        out.push_back(at->second);
    };
    const double from = wrap(*low, kTwoPi);
    add(from, from + width);
    if (from + width > kTwoPi)
      add(0.0, from + width - kTwoPi);
    std::sort(out.begin(), out.end());
    return out;
  }

  const std::vector<double> &way_;
  std::vector<std::pair<double, std::uint32_t>> by_place_;
};

/// Whether no magnet does it, at whatever place of the turn: the vector gets half as long again at
/// least, and that at once. A worn ring or a cable does; a pole that is missing shortens it.
bool is_no_field(const Off &off, const RowRange &r) {
  constexpr double kOfRadius = 0.5;
  double most = 0.0, step = 0.0;
  for (std::size_t i = r.first; i < r.end; ++i) {
    most = std::max(most, off.along[i]);
    if (i > r.first)
      step = std::max(step, std::abs(off.along[i] - off.along[i - 1]));
  }
  return most > kOfRadius && step > 0.5 * most;
}

/// Takes out what comes again each time the shaft passes: a weak pole or a chip of the magnet
/// belongs to the angle. What is no field stays; the number of those that come again.
std::size_t leave_to_the_angle(const Capture &c, const Off &off, std::vector<RowRange> &rows) {
  const std::vector<double> way = way_of(c, off.psi);
  const auto [low, high] = std::minmax_element(way.begin(), way.end());
  if (rows.size() > kMostCompared || *high - *low < kTwoPi)
    return 0;
  const Places places(way);
  const auto most = [](const std::vector<double> &by, const RowRange &r) {
    double out = 0.0;
    for (std::size_t i = r.first; i < r.end; ++i)
      out = std::max(out, std::abs(by[i]));
    return out;
  };
  std::size_t stay = 0;
  std::erase_if(rows, [&](const RowRange &r) {
    if (!places.recurs(r, most(off.along, r) >= most(off.across, r) ? off.along : off.across))
      return false;
    const bool stays = is_no_field(off, r);
    stay += stays ? 1 : 0;
    return !stays;
  });
  return stay;
}

} // namespace

Episodes &Episodes::operator+=(const Episodes &more) {
  if (more.count != 0 && (count == 0 || more.first_s < first_s))
    first_s = more.first_s;
  if (more.count != 0)
    at_one_place = more.at_one_place && (count == 0 || at_one_place);
  count += more.count;
  samples += more.samples;
  longest_s = std::max(longest_s, more.longest_s);
  squares_v2 += more.squares_v2;
  worst_v = std::max(worst_v, more.worst_v);
  return *this;
}

Episodes leave_out_episodes(const Capture &capture, std::span<char> usable) {
  const std::size_t n = capture.size();
  const Pair read{capture.vsin_v, capture.vcos_v};
  std::optional<EllipseParameters> curve = curve_of(read, usable);
  if (!curve)
    return {};
  Off off = off_curve(capture, read, *curve, usable);
  // A supply that is recorded and moves both outputs leaves the curve for nobody's fault.
  if (const auto ratio = over_supply(capture)) {
    const Pair followed{ratio->sin_v, ratio->cos_v};
    if (const auto other = curve_of(followed, usable)) {
      Off of_ratio = off_curve(capture, followed, *other, usable);
      if (spread_but_for_rare(of_ratio.along) < kFollowsSupply * spread_but_for_rare(off.along)) {
        curve = other;
        off = std::move(of_ratio);
      }
    }
  }
  std::vector<RowRange> apart;
  if (capture.has_reference())
    apart = rows_of(off.across, robust_spread(off.across));
  std::erase_if(apart, [&](const RowRange &r) { return !is_abrupt(off.across, r); });
  std::vector<RowRange> rows = joined(rows_of(off.along, robust_spread(off.along)), apart);
  const std::size_t at_one_place = leave_to_the_angle(capture, off, rows);
  if (2 * at_one_place > rows.size()) { // at a higher speed the same takes fewer samples
    std::vector<RowRange> all = rows_of(off.along, robust_spread(off.along), 1);
    std::erase_if(all, [&](const RowRange &r) { return !is_no_field(off, r); });
    rows = joined(std::move(rows), all);
  }
  if (rows.empty() || rows.front().first == 0 || rows.back().end == n)
    return {};
  Episodes out;
  out.at_one_place = 2 * at_one_place > rows.size();
  for (const RowRange &r : rows) {
    out.samples += r.end - r.first;
    out.longest_s = std::max(out.longest_s, capture.time_s[r.end - 1] - capture.time_s[r.first]);
    for (std::size_t i = r.first; i < r.end; ++i) {
      const double by_v =
          curve->amplitude_v * std::hypot(off.along[i], 2.0 * std::sin(0.5 * off.across[i]));
      out.squares_v2 += by_v * by_v;
      out.worst_v = std::max(out.worst_v, by_v);
    }
  }
  out.count = rows.size();
  out.first_s = capture.time_s[rows.front().first];
  if (static_cast<double>(out.samples) > criteria::kMostOfEpisodes * static_cast<double>(n) ||
      !(out.at_one_place || come_at_any_angle(rows, off.psi)))
    return {};
  for (const RowRange &r : rows)
    std::fill(usable.begin() + static_cast<std::ptrdiff_t>(r.first),
              usable.begin() + static_cast<std::ptrdiff_t>(r.end), char{0});
  return out;
}

} // namespace ada
