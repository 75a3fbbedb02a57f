// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/noise/spikes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <iterator>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/noise/along_and_across.h"
#include "diagnosis/search/fit.h"
#include "model/residual.h"

namespace ada {

namespace {

constexpr double kStandsOut = 5.5; ///< standard deviations
/// A choice: one to three samples may be the edges of something else. Below sixteen nothing tells
/// whether they come at one place in the turn (come_with_the_angle).
constexpr std::size_t kFewestSpikes = 4;
/// What has no name is so many times what neighbours leave: white noise is 0.9 times that.
constexpr double kDrowned = 2.0;

using Pair = std::array<double, 2>; ///< VSIN, VCOS

double log_normal(double x, double variance) {
  return -0.5 * (std::log(kTwoPi * variance) + x * x / variance);
}

/// Channel values, spiked or not: what they are tested on.
struct ChannelValues {
  std::vector<double> plain, spiked;
};

/// How many spikes may come together by chance where so many of so many samples have one: more in
/// a row are a kink of the motion or a step.
int most_together(double spikes, double samples, double neighbours) {
  constexpr double kByChance = 0.05; // of one such cluster in the whole record
  const double expected = neighbours * spikes / samples;
  int others = 1;
  double probability = expected; // Poisson's, of so many others, leading term
  while (others < 2 || spikes * probability > kByChance)
    probability *= expected / ++others;
  return others;
}

/// A spike stands alone, or few chance to come close.
void leave_out_clusters(std::vector<char> &hit) {
  constexpr std::size_t kNear = 4;
  const std::vector<char> all = hit;
  const auto hits = static_cast<double>(std::count(all.begin(), all.end(), char{1}));
  const int most = most_together(hits, static_cast<double>(all.size()), 2.0 * kNear);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!all[i])
      continue;
    const auto from = all.begin() + static_cast<std::ptrdiff_t>(i > kNear ? i - kNear : 0);
    const auto to = all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), i + kNear + 1));
    if (std::count(from, to, char{1}) > most)
      hit[i] = 0;
  }
}

/// Samples on either side that one is held against.
constexpr std::size_t kEach = 2;

/// Residual of the usable samples on either side of a place, in the middle: what the model misses
/// there anyway, whether or not one of them is a spike as well.
Pair beside(const ResidualColumns &r, std::size_t before, std::size_t after) {
  std::array<std::vector<double>, 2> near;
  const auto take = [&](std::size_t i) {
    near[0].push_back(r.sin[i]);
    near[1].push_back(r.cos[i]);
  };
  for (std::size_t k = 0; k < kEach; ++k) {
    if (before > k)
      take(before - k - 1);
    if (after + k < r.sin.size())
      take(after + k);
  }
  const auto middle = [](std::vector<double> &v) {
    std::sort(v.begin(), v.end());
    return v.empty() ? 0.0 : 0.5 * (v[(v.size() - 1) / 2] + v[v.size() / 2]);
  };
  return {middle(near[0]), middle(near[1])};
}

/// What a sample is apart from where those beside it lead, by the line before it, by the line
/// behind it or by the curve through both, whichever comes nearest: what the model misses is
/// smooth, so the neighbours have it as well, and one of them may have a spike of its own. Where
/// rows are missing nothing is known: 0. `at`: its row; `next`: the first of `rows` behind it,
/// `before`: those ahead.
double apart_from(const std::vector<double> &x, const std::vector<std::uint32_t> &rows,
                  double value, std::uint32_t at, std::size_t before, std::size_t next) {
  if (before < kEach || next + kEach > rows.size() || at - rows[before - kEach] > 2 * kEach ||
      rows[next + kEach - 1] - at > 2 * kEach)
    return 0.0;
  const std::array<std::size_t, 4> near{before - 2, before - 1, next, next + 1};
  std::array<double, 4> t, v;
  for (std::size_t k = 0; k < near.size(); ++k) {
    t[k] = static_cast<double>(rows[near[k]]) - static_cast<double>(at);
    v[k] = x[near[k]];
  }
  // Polynomials through some of them, at 0 (Lagrange).
  const auto led_to = [&](std::size_t first, std::size_t end) {
    double sum = 0.0;
    for (std::size_t k = first; k < end; ++k) {
      double part = v[k];
      for (std::size_t m = first; m < end; ++m)
        if (m != k)
          part *= t[m] / (t[m] - t[k]);
      sum += part;
    }
    return sum;
  };
  double least = value - led_to(0, 4);
  for (std::size_t first : {0, 2})
    if (const double off = value - led_to(first, first + 2); std::abs(off) < std::abs(least))
      least = off;
  return least;
}

void hold_against_neighbours(const std::vector<std::uint32_t> &rows, ResidualColumns &r) {
  for (std::vector<double> *of : {&r.sin, &r.cos}) {
    const std::vector<double> all = *of;
    for (std::size_t i = 0; i < all.size(); ++i)
      (*of)[i] = apart_from(all, rows, all[i], rows[i], i, i + 1);
  }
}

/// The same of samples that stand apart, of these rows; `next`: the first sample of `r` behind
/// each.
void hold_against(const ResidualColumns &r, const std::vector<std::uint32_t> &rows,
                  const std::vector<std::uint32_t> &apart_rows,
                  const std::vector<std::size_t> &next, ResidualColumns &apart) {
  for (std::size_t k = 0; k < next.size(); ++k) {
    apart.sin[k] = apart_from(r.sin, rows, apart.sin[k], apart_rows[k], next[k], next[k]);
    apart.cos[k] = apart_from(r.cos, rows, apart.cos[k], apart_rows[k], next[k], next[k]);
  }
}

/// Holds all against neighbours that were not hit: beside two spikes at once a sound sample stands
/// out as well.
void hold_against_sound(const ResidualColumns &r, const std::vector<std::uint32_t> &rows,
                        const std::vector<char> &hit, ResidualColumns &held) {
  ResidualColumns sound;
  std::vector<std::uint32_t> sound_rows;
  std::vector<std::size_t> next(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    next[i] = sound_rows.size();
    if (!hit[i]) {
      sound.sin.push_back(r.sin[i]);
      sound.cos.push_back(r.cos[i]);
      sound_rows.push_back(rows[i]);
    }
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::size_t behind = next[i] + (hit[i] ? 0 : 1);
    held.sin[i] = apart_from(sound.sin, sound_rows, r.sin[i], rows[i], next[i], behind);
    held.cos[i] = apart_from(sound.cos, sound_rows, r.cos[i], rows[i], next[i], behind);
  }
}

/// Noise where it is loudest, V rms of a channel: of stretches of samples in a row.
double loudest_of(const ResidualColumns &r) {
  constexpr std::size_t kStretch = 64; // samples
  constexpr double kMost = 0.9;        // of the stretches; a tenth of them may hold spikes
  std::vector<double> rms;
  for (std::size_t from = 0; from + kStretch <= r.sin.size(); from += kStretch) {
    double sum = 0.0;
    for (std::size_t i = from; i < from + kStretch; ++i)
      sum += r.sin[i] * r.sin[i] + r.cos[i] * r.cos[i];
    rms.push_back(std::sqrt(0.5 * sum / kStretch));
  }
  return quantile(std::move(rms), kMost);
}

/// The same by medians, which spikes in many rows do not move.
double loudest_but_for_spikes(const ResidualColumns &r) {
  constexpr std::size_t kStretch = 64; // samples
  constexpr double kMost = 0.9;        // of the stretches
  const std::size_t n = r.sin.size();
  std::vector<double> spreads;
  for (std::size_t from = 0; from < n; from += kStretch) {
    const std::size_t end = from + 2 * kStretch > n ? n : from + kStretch; // the rest with the last
    std::vector<double> off;
    for (std::size_t i = from; i < end; ++i)
      for (double v : {r.sin[i], r.cos[i]})
        off.push_back(std::abs(v));
    spreads.push_back(kSigmasOfMedian * quantile(std::move(off), 0.5));
    if (end == n)
      break;
  }
  return quantile(std::move(spreads), kMost);
}

/// Whether what stands out is apart from the rest, and not the tail of what jumps by all sizes: no
/// more lie in the last third below the limit than this part of those above it, beyond those of
/// normal noise.
bool are_apart(const ResidualColumns &r, const ResidualColumns &others, double noise_v,
               double part = 1.0) {
  constexpr double kTwoThirds = 2.0 / 3.0 * kStandsOut;
  const double by_chance = std::erfc(kTwoThirds / std::numbers::sqrt2); // of one channel
  double below = 0.0, above = 0.0;
  for (const std::vector<double> *of : {&r.sin, &r.cos, &others.sin, &others.cos})
    for (double v : *of)
      (std::abs(v) > kStandsOut * noise_v ? above : below) +=
          std::abs(v) > kTwoThirds * noise_v ? 1.0 : 0.0;
  return below <= part * above + by_chance * 2.0 * static_cast<double>(r.sin.size());
}

constexpr std::size_t kMostKnown = 20000; ///< values that a rank or a noise is known by

/// Of many values some, in step with nothing.
std::vector<std::uint32_t> some_of(std::size_t size, std::size_t most) {
  std::vector<std::uint32_t> out(size);
  std::iota(out.begin(), out.end(), 0u);
  return thin(std::move(out), most, 1);
}

/// Whether more than a few of many samples are far beyond what their median tells of the noise.
bool may_be_many(const ResidualColumns &r) {
  constexpr double kMany = 0.003; // of the samples
  std::size_t beyond = 0;
  const std::vector<std::uint32_t> some = some_of(r.sin.size(), kMostKnown);
  for (const std::vector<double> *of : {&r.sin, &r.cos}) {
    std::vector<double> off;
    for (std::uint32_t i : some)
      off.push_back(std::abs((*of)[i]));
    const double limit = kStandsOut * kSigmasOfMedian * quantile(off, 0.5);
    beyond +=
        static_cast<std::size_t>(std::ranges::count_if(off, [&](double v) { return v > limit; }));
  }
  return static_cast<double>(beyond) > kMany * static_cast<double>(some.size());
}

/// Whether a sample stands out of those about it. Where the model misses those as well it says
/// nothing of a single sample.
bool stands_out(double sin, double cos, const Pair &around, double noise_v) {
  constexpr double kMissed = 4.0; // standard deviations, of the middle of four
  if (std::max(std::abs(around[0]), std::abs(around[1])) > kMissed * noise_v)
    return false;
  return std::max(std::abs(sin - around[0]), std::abs(cos - around[1])) > kStandsOut * noise_v;
}

/// Rows about a gap in the clock: a spike is held against the rows on either side of it.
class Gaps {
public:
  Gaps(const std::vector<double> &time, const std::vector<std::uint32_t> &jumps)
      : time_(time), jumps_(jumps), most_s_(kMissing * median_step(time)) {}
  bool about(std::size_t row) const {
    const auto jump = std::lower_bound(jumps_.begin(), jumps_.end(), row > kEach ? row - kEach : 0);
    if (jump != jumps_.end() && *jump <= row + kEach)
      return true;
    for (std::size_t k = row > kEach ? row - kEach : 0; k < row + kEach && k + 1 < time_.size();
         ++k)
      if (time_[k + 1] - time_[k] > most_s_)
        return true;
    return false;
  }

private:
  static constexpr double kMissing = 1.5; ///< usual steps: one row is missing
  const std::vector<double> &time_;
  const std::vector<std::uint32_t> &jumps_;
  double most_s_;
};

/// How far some of the samples are from the curve that the pair draws, V.
std::vector<double> off_curve_v(const Observations &data, const std::vector<std::uint32_t> &asked,
                                const Model &model) {
  if (asked.empty())
    return {};
  Observations some = data.select(asked);
  constexpr int kPasses = 3; // the shaft may have moved far
  for (int pass = 0; pass < kPasses; ++pass)
    some = at_own_angle(std::move(some), model);
  const ResidualColumns left = residual_columns(some, model);
  std::vector<double> out;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const auto [sin, cos] = some.outward(left.model_sin[k], left.model_cos[k]);
    out.push_back(std::abs(left.sin[k] * sin + left.cos[k] * cos));
  }
  return out;
}

/// Samples about a gap, or a jump of the pair's own angle, that may lie where they do because the
/// shaft moved on: without a reference nobody knows how it did, and the pair is met at another
/// angle. `asked`: of `data`, whose rows in the capture are `rows`.
std::vector<std::uint32_t> moved_on(const Scene &scene, const Observations &data,
                                    const std::vector<std::uint32_t> &rows,
                                    std::vector<std::uint32_t> asked, const Model &model,
                                    double noise_v) {
  if (scene.has_reference || asked.empty())
    return {};
  const Gaps gaps(scene.capture->time_s, scene.own_jumps.rows);
  std::erase_if(asked, [&](std::uint32_t i) { return !gaps.about(rows[i]); });
  const std::vector<double> left = off_curve_v(data, asked, model);
  std::vector<std::uint32_t> out;
  for (std::size_t k = 0; k < asked.size(); ++k)
    if (left[k] <= kStandsOut * noise_v)
      out.push_back(asked[k]);
  return out;
}

/// Of samples that stand out of the motion, how many lie on the curve that the pair draws all the
/// same. A spike hits the channels, whatever the angle: of those that just stand out, which are
/// kStandsOut noises wide, a third lies within kOnCurve of them. A shaft that jerks, and a sample
/// or a reference that came late, move the pair along the curve. Of four spikes all lie on it once
/// in fifty.
constexpr double kMostOnCurve = 0.8; ///< of the spikes
std::size_t on_curve(const Observations &data, const std::vector<std::uint32_t> &asked,
                     const Model &model, double noise_v) {
  constexpr double kOnCurve = 3.0; // noises
  const std::vector<double> left = off_curve_v(data, asked, model);
  return static_cast<std::size_t>(
      std::count_if(left.begin(), left.end(), [&](double v) { return v <= kOnCurve * noise_v; }));
}

/// Spikes come at any angle and at any voltage. What stands out again and again at the same ones is
/// a corner that the model does not meet quite, or a kink of a converter.
constexpr int kOrders = 16;          ///< of the turn that are looked at
constexpr double kImprobable = 1e-3; ///< by chance

constexpr std::size_t kMostAsked = 2000;  ///< of what stands out: of more Rayleigh's test tells

/// Part of a distribution that lies below a place, and that with the place: the same but for ties.
struct Rank {
  double below, with;
};

/// Bound on the chance that so many of n places, each anywhere in a distribution, are as close
/// together as most of these are: of n choose m sets of m, each begins at one of them and has the
/// others within its width (Naus, J. Am. Stat. Assoc. 60, 1965, by Bonferroni's inequality).
/// `round`: the end is the beginning again.
double chance_of_gathering(std::vector<Rank> places, bool round) {
  constexpr double kFewest = 2.0 / 3.0, kMost = 0.95; // nearly all together is a gap, no place
  std::ranges::sort(places, {}, &Rank::below);
  const std::size_t n = places.size();
  const auto all = static_cast<double>(n);
  const auto fewest = std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(kFewest * all)));
  const std::size_t most = std::max(fewest, static_cast<std::size_t>(kMost * all));
  double least = 0.0; // logarithm
  for (std::size_t m = fewest; m <= std::min(most, n); ++m) {
    double width = 1.0;
    for (std::size_t first = 0; first < (round ? n : n + 1 - m); ++first) {
      const std::size_t last = first + m - 1;
      width =
          std::min(width, places[last % n].with + (last >= n ? 1.0 : 0.0) - places[first].below);
    }
    const auto others = static_cast<double>(m - 1);
    const double sets =
        std::log(all) + std::lgamma(all) - std::lgamma(others + 1.0) - std::lgamma(all - others);
    least = std::min(least, sets + others * std::log(std::max(width, 1e-12)));
  }
  return std::exp(least) * static_cast<double>(most + 1 - fewest);
}

std::vector<Rank> ranks(const std::vector<double> &x, const std::vector<double> &sorted) {
  const auto part = [&](auto at) {
    return static_cast<double>(at - sorted.begin()) / static_cast<double>(sorted.size());
  };
  std::vector<Rank> out;
  for (double v : x)
    out.push_back(
        {part(std::ranges::lower_bound(sorted, v)), part(std::ranges::upper_bound(sorted, v))});
  return out;
}

/// At each of the first orders of the turn, against the angles at which the shaft was: Rayleigh's
/// test, and of few, or of a narrow place, how close together most of them are.
bool come_with_the_angle(const std::vector<double> &alpha, const std::vector<double> &all) {
  const std::vector<std::uint32_t> known = some_of(all.size(), kMostKnown),
                                   asked = some_of(alpha.size(), kMostAsked);
  const double n = static_cast<double>(asked.size());
  for (int k = 1; k <= kOrders; ++k) {
    std::vector<double> hits, was;
    std::complex<double> sum, mean;
    for (std::uint32_t i : asked) {
      hits.push_back(wrap(k * alpha[i], kTwoPi));
      sum += std::polar(1.0, hits.back());
    }
    for (std::uint32_t i : known) {
      was.push_back(wrap(k * all[i], kTwoPi));
      mean += std::polar(1.0, was.back());
    }
    mean /= static_cast<double>(was.size());
    std::ranges::sort(was);
    if (kOrders * std::min(std::exp(-std::norm(sum - n * mean) / n),
                           chance_of_gathering(ranks(hits, was), true)) <
        kImprobable)
      return true;
  }
  return false;
}

/// What a channel has where nothing stands out of it.
std::vector<double> levels_of(const std::vector<float> &v, const std::vector<double> &rest) {
  std::vector<double> out;
  for (std::uint32_t i : some_of(v.size(), kMostKnown))
    out.push_back(v[i] - rest[i]);
  std::ranges::sort(out);
  return out;
}

/// The voltage about which most of what stands out lies in its own channel, where that is no
/// chance. `level`: of each channel, without what stands out; `all`: the same of all samples.
std::optional<double> common_level(const std::array<std::vector<double>, 2> &level,
                                   const std::array<std::vector<double>, 2> &all) {
  std::vector<Rank> places;
  std::vector<double> volts;
  for (std::size_t channel = 0; channel < 2; ++channel) {
    std::ranges::copy(ranks(level[channel], all[channel]), std::back_inserter(places));
    std::ranges::copy(level[channel], std::back_inserter(volts));
  }
  if (places.size() > kMostAsked || !(chance_of_gathering(places, false) < kImprobable))
    return std::nullopt;
  const auto middle = volts.begin() + static_cast<std::ptrdiff_t>(volts.size() / 2);
  std::ranges::nth_element(volts, middle);
  return *middle;
}

/// The place in the turn about which most of `alpha` lie, rad.
double densest(const std::vector<double> &alpha) {
  constexpr std::size_t kPlaces = 4 * kOrders;
  std::array<std::size_t, kPlaces> count{};
  for (double a : alpha)
    ++count[std::min(kPlaces - 1, static_cast<std::size_t>(wrap(a, kTwoPi) / kTwoPi * kPlaces))];
  const auto most = std::max_element(count.begin(), count.end()) - count.begin();
  return (static_cast<double>(most) + 0.5) * kTwoPi / kPlaces;
}

void add(const ResidualColumns &r, std::size_t i, std::vector<double> &out,
         const Pair &around = {}) {
  out.push_back(r.sin[i] - around[0]);
  out.push_back(r.cos[i] - around[1]);
}

/// Log likelihood a sample of all values under noise of `variance`, with a part `share` of them
/// that has `more` on top.
double likelihood(const ChannelValues &values, double variance, double share, double more) {
  double sum = 0.0, n = 0.0;
  for (const auto *v : {&values.plain, &values.spiked})
    for (double x : *v) {
      sum += share > 0.0 ? std::log((1.0 - share) * std::exp(log_normal(x, variance)) +
                                    share * std::exp(log_normal(x, variance + more)))
                         : log_normal(x, variance);
      n += 0.5;
    }
  return n > 0.0 ? sum / n : 0.0;
}

/// Residuals as `data` weighs them.
ResidualColumns whitened(const Observations &data, const ResidualColumns &r) {
  ResidualColumns out;
  out.sin = r.sin;
  out.cos = r.cos;
  for (std::size_t i = 0; i < data.size(); ++i)
    data.whiten(i, r.model_sin[i], r.model_cos[i], out.sin[i], out.cos[i]);
  return out;
}

} // namespace

Spikes spikes_against(const Scene &scene, const Model &model,
                      const std::vector<std::uint32_t> &heldout, double noise_v) {
  Spikes out;
  out.hit.assign(scene.all.size(), 0);
  ResidualColumns plain = residuals_alone(scene.all, model);
  // Where the angle is the pair's own it is theirs as well: at that of a motion which nobody knows
  // they would stand out of neighbours that are at their own.
  ResidualColumns apart =
      residual_columns(scene.radius_only ? at_own_angle(scene.spiked, model) : scene.spiked, model);
  ResidualColumns weighed, apart_weighed;
  if (scene.all.weight_along != 1.0)
    weighed = whitened(scene.all, residual_columns(scene.all, model));
  // A supply that is not recorded moves the neighbours as well, and is taken off.
  const bool supply = scene.all.disturbed == Direction::supply && scene.all.weight_along != 1.0;
  if (supply)
    apart_weighed = whitened(scene.spiked, apart);
  std::vector<std::size_t> next_of; // of those apart, the first usable sample behind each
  for (std::uint32_t row : scene.spiked_index)
    next_of.push_back(static_cast<std::size_t>(
        std::lower_bound(scene.index.begin(), scene.index.end(), row) - scene.index.begin()));
  // Where what has no name drowns a spike that its neighbours show, those are what it is held
  // against.
  // A reading that flickers by a count of the converter is no spike, nor are moves from one place
  // to the next smooth.
  constexpr double kCounts = 2.5; // that stand out
  const double step_v = std::max(converter_step(scene.all.vsin), converter_step(scene.all.vcos));
  const double least_v = std::max(scene.white_noise_v, kCounts / kStandsOut * step_v);
  if (!supply && !scene.stops && kDrowned * least_v < noise_v) {
    ResidualColumns held = plain, held_apart = apart;
    hold_against(plain, scene.index, scene.spiked_index, next_of, held_apart);
    hold_against_neighbours(scene.index, held);
    const double local_v = std::max(loudest_of(held), least_v);
    if (local_v > 0.0 && kDrowned * local_v < noise_v && are_apart(held, held_apart, local_v)) {
      noise_v = local_v;
      plain = std::move(held);
      apart = std::move(held_apart);
      weighed = {}; // the motion that is read off the pair is smooth as well
    }
  }
  const ResidualColumns &white = weighed.sin.empty() ? plain : weighed;
  const ResidualColumns &here = supply ? white : plain;
  const ResidualColumns &there = supply ? apart_weighed : apart;
  std::vector<std::size_t> places;
  for (const auto *v : {&white.sin, &white.cos}) {
    find_spikes(*v, kStandsOut, noise_v, places);
    for (std::size_t i : places)
      out.hit[i] = 1;
  }
  // Spikes in many rows are as much of what is left as the noise is, and few of them are rare. Held
  // against their neighbours they are what is apart from all others.
  const auto first = static_cast<double>(std::ranges::count(out.hit, char{1})) +
                     static_cast<double>(apart.sin.size());
  if (!supply && !scene.stops && plain.sin.size() == scene.index.size() && may_be_many(plain)) {
    // One in so many samples, at most, and so many times what was found before.
    constexpr double kOften = 12.0, kMore = 1.5;
    // Of spikes whose size is normal, of ten noises rms, a sixth lies in that third.
    constexpr double kPartBelow = 0.5;
    ResidualColumns held = plain, held_apart = apart;
    hold_against(plain, scene.index, scene.spiked_index, next_of, held_apart);
    hold_against_neighbours(scene.index, held);
    const double local_v = std::max(loudest_but_for_spikes(held), least_v);
    std::vector<char> often(out.hit.size(), 0);
    const auto mark = [&] {
      for (std::size_t i = 0; i < often.size(); ++i)
        often[i] = std::max(std::abs(held.sin[i]), std::abs(held.cos[i])) > kStandsOut * local_v;
    };
    mark();
    hold_against_sound(plain, scene.index, often, held);
    mark();
    const double all = static_cast<double>(std::ranges::count(often, char{1})) +
                       static_cast<double>(apart.sin.size());
    if (local_v > 0.0 && all * kOften <= static_cast<double>(often.size()) && all > kMore * first &&
        are_apart(held, held_apart, local_v, kPartBelow)) {
      noise_v = local_v;
      plain = std::move(held);
      apart = std::move(held_apart);
      weighed = {};
      out.hit = std::move(often);
    }
  }
  const std::vector<char> all_hit = out.hit;
  leave_out_clusters(out.hit);
  // What stands out together with its neighbours is no spike, and is not passed over either.
  std::vector<double> together;
  for (std::size_t i = 0; i < out.hit.size(); ++i)
    if (all_hit[i] && !out.hit[i])
      add(plain, i, together);
  // Of what the first look left out, only what this model cannot explain either is a spike.
  std::vector<double> values, angles;
  std::array<std::vector<double>, 2> levels; // of the channel that stands out
  // Of a pair that tells its angle itself a spike has moved that as well, and with it what the
  // model has there: what lies on both sides says where the shaft was.
  const auto note_place = [&](const Observations &data, const ResidualColumns &r, std::size_t i,
                              std::size_t before, std::size_t after) {
    double sin = r.sin[i], cos = r.cos[i], angle = data.alpha[i];
    const Observations &all = scene.all;
    if (!scene.has_reference && before < after && after < all.size()) {
      const double took = all.time[after] - all.time[before];
      const double part = took > 0.0 ? (data.time[i] - all.time[before]) / took : 0.5;
      angle = all.alpha[before] + part * (all.alpha[after] - all.alpha[before]);
      Observations there_alone = data.select({static_cast<std::uint32_t>(i)});
      there_alone.alpha[0] = angle;
      const ResidualColumns left = residual_columns(there_alone, model);
      sin = left.sin[0];
      cos = left.cos[0];
    }
    angles.push_back(angle);
    if (std::abs(sin) > std::abs(cos))
      levels[0].push_back(data.vsin[i] - sin);
    else
      levels[1].push_back(data.vcos[i] - cos);
  };
  std::vector<std::uint32_t> spiked; // of those
  std::vector<std::uint32_t> asked(apart.sin.size());
  std::iota(asked.begin(), asked.end(), 0u);
  const std::vector<std::uint32_t> motion =
      moved_on(scene, scene.spiked, scene.spiked_index, std::move(asked), model, noise_v);
  for (std::size_t i = 0; i < apart.sin.size(); ++i) {
    const std::size_t next = next_of[i];
    if (std::binary_search(motion.begin(), motion.end(), static_cast<std::uint32_t>(i)) ||
        !stands_out(there.sin[i], there.cos[i], beside(here, next, next), noise_v))
      continue;
    note_place(scene.spiked, apart, i, next > 0 ? next - 1 : next, next);
    add(apart, i, values, supply ? beside(plain, next, next) : Pair{});
    spiked.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<std::uint32_t> hit_places;
  for (std::size_t i = 0; i < out.hit.size(); ++i)
    if (out.hit[i])
      hit_places.push_back(static_cast<std::uint32_t>(i));
  for (std::uint32_t i : moved_on(scene, scene.all, scene.index, hit_places, model, noise_v))
    out.hit[i] = 0;
  hit_places.clear();
  for (std::size_t i = 0; i < out.hit.size(); ++i)
    if (out.hit[i]) {
      if (!stands_out(here.sin[i], here.cos[i], beside(here, i, i + 1), noise_v)) {
        out.hit[i] = 0;
        continue;
      }
      add(plain, i, values, supply ? beside(plain, i, i + 1) : Pair{});
      note_place(scene.all, plain, i, i > 0 ? i - 1 : i, i + 1);
      hit_places.push_back(static_cast<std::uint32_t>(i));
    }
  const std::size_t samples = spiked.size() + hit_places.size();
  const bool enough = samples >= kFewestSpikes;
  const bool at_places = enough && come_with_the_angle(angles, scene.all.alpha);
  const bool along =
      enough && static_cast<double>(on_curve(scene.spiked, spiked, model, noise_v) +
                                    on_curve(scene.all, hit_places, model, noise_v)) >
                    kMostOnCurve * static_cast<double>(samples);
  const std::optional<double> level =
      enough && !at_places ? common_level(levels, {levels_of(scene.all.vsin, plain.sin),
                                                   levels_of(scene.all.vcos, plain.cos)})
                           : std::nullopt;
  if (at_places || level || along)
    together.insert(together.end(), values.begin(), values.end());
  if (together.size() >= 2 * kFewestSpikes) {
    out.no_spikes.count = together.size() / 2;
    out.no_spikes.rms_v = std::sqrt(mean_square(together));
    if (at_places)
      out.no_spikes.place_rad = densest(angles);
    out.no_spikes.level_v = level;
    out.no_spikes.on_curve = along && !at_places && !level;
  }
  if (!enough) { // whatever the first look left out is said
    out.few.count = apart.sin.size();
    std::vector<double> left_out;
    for (std::size_t i = 0; i < apart.sin.size(); ++i) {
      add(apart, i, left_out);
      out.few.worst_v = std::max({out.few.worst_v, std::abs(apart.sin[i]), std::abs(apart.cos[i])});
    }
    out.few.rms_v = left_out.empty() ? 0.0 : std::sqrt(mean_square(left_out));
  }
  if (!enough || at_places || level || along) {
    std::fill(out.hit.begin(), out.hit.end(), char{0});
    return out;
  }
  out.found = true;
  const double n = static_cast<double>(scene.all.size() + scene.spiked.size());
  const double hits = static_cast<double>(samples);
  // Spikes of one channel at a time leave the other at its noise.
  const auto flagged = std::count_if(values.begin(), values.end(),
                                     [&](double v) { return std::abs(v) > kStandsOut * noise_v; });
  const double channels = static_cast<double>(flagged) > 1.5 * hits ? 2.0 : 1.0;
  const double noise2 = noise_v * noise_v;
  const double square = (2.0 * mean_square(values) - (2.0 - channels) * noise2) / channels;
  out.rate = hits / n;
  out.rate_error = std::sqrt(hits) / n;
  out.amplitude_v = std::sqrt(std::max(square - noise2, 0.0));
  out.amplitude_error_v = out.amplitude_v / std::sqrt(2.0 * channels * hits);
  if (scene.radius_only) {
    // Only what lies along the vector shows: all of a spike's rms where both channels have one at
    // once, and its share of root 2 where it is one of them. The middle of the two, and half of
    // their distance as an error.
    constexpr double kMiddle = 0.5 * (1.0 + std::numbers::sqrt2),
                     kHalf = 0.5 * (std::numbers::sqrt2 - 1.0);
    const double along_v = std::sqrt(std::max(2.0 * mean_square(values) - noise2, 0.0));
    out.amplitude_v = kMiddle * along_v;
    out.amplitude_error_v = std::hypot(kHalf * along_v, out.amplitude_v / std::sqrt(2.0 * hits));
  }

  // What the knowledge of the spikes is worth on turns that no fit has seen.
  std::vector<char> judged(scene.all.size(), heldout.empty());
  for (std::uint32_t i : heldout)
    judged[i] = 1;
  ChannelValues test;
  for (std::size_t i = 0; i < judged.size(); ++i)
    if (judged[i])
      add(plain, i, out.hit[i] ? test.spiked : test.plain);
  for (std::size_t k = 0; k < scene.spiked_index.size(); ++k) {
    if (judged[std::min(next_of[k], judged.size() - 1)])
      add(apart, k, test.spiked);
  }
  const double variance = mean_square(test.plain);
  const double all = (variance * static_cast<double>(test.plain.size()) +
                      mean_square(test.spiked) * static_cast<double>(test.spiked.size())) /
                     static_cast<double>(test.plain.size() + test.spiked.size());
  out.before = likelihood(test, all, 0.0, 0.0);
  out.after =
      likelihood(test, variance, 0.5 * channels * out.rate, out.amplitude_v * out.amplitude_v);
  return out;
}

double rms_in_any_direction(const Observations &data, const Model &model, bool has_reference) {
  const ResidualColumns r =
      residual_columns(has_reference ? data : at_own_angle(data, model), model);
  std::array<double, 5> sum{};
  for (std::size_t i = 0; i < data.size(); ++i) {
    const double x = r.sin[i], y = r.cos[i];
    const double vs = r.model_sin[i], vc = r.model_cos[i];
    const auto [s, c] = data.outward(vs, vc);
    const double along = (x * vs + y * vc) / std::hypot(vs, vc);
    const double across = (x * vc - y * vs) / std::hypot(vs, vc);
    const double outward = x * s + y * c;
    const std::array<double, 5> part{x, y, along, across, outward};
    for (std::size_t k = 0; k < part.size(); ++k)
      sum[k] += part[k] * part[k];
  }
  const double least = has_reference ? *std::min_element(sum.begin(), sum.end()) : sum.back();
  return std::sqrt(least / static_cast<double>(std::max<std::size_t>(1, data.size())));
}

double loudest_noise(const Observations &data, const Model &model) {
  return loudest_of(residuals_alone(data, model));
}

} // namespace ada
