// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/reference_zero.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/angle.h"
#include "diagnosis/criteria.h"
#include "diagnosis/search/first_model.h"
#include "diagnosis/search/fit.h"

namespace ada {

/// Means over parts of the turn, each of which holds a whole number to the period.
struct ReferenceZero::Pattern {
  std::vector<double> sin, cos, count;
  double variance = 0.0; ///< of a sample about the mean of its part
};

ReferenceZero::ReferenceZero(const Scene &record) : periods_(record.periods) {
  Model model = with_expected(first_model(record, nullptr));
  std::vector<std::uint32_t> every(record.all.size());
  std::iota(every.begin(), every.end(), 0u);
  const Observations some = record.all.select(thin(every, criteria::kAnonymousHeldout, 50));
  // With the ellipse, so that uneven stretches of the circle do not bend the zero.
  model = fit(some, model, 10).model;
  zero_rad_ = model.baseline.angle_zero_deg * kRadPerDeg;
  ResidualColumns left = residuals_alone(some, model);
  alpha_ = some.alpha;
  sin_ = std::move(left.sin);
  cos_ = std::move(left.cos);
}

ReferenceZero::Pattern ReferenceZero::pattern(double moved_rad) const {
  constexpr int kParts = 36; // the orders that fill a turn unevenly are low
  const int parts = periods_ * ((kParts + periods_ - 1) / periods_);
  Pattern out;
  out.sin.assign(static_cast<std::size_t>(parts), 0.0);
  out.cos = out.count = out.sin;
  double squares = 0.0;
  for (std::size_t i = 0; i < alpha_.size(); ++i) {
    const double turn = wrap(alpha_[i] + moved_rad, kTwoPi) / kTwoPi;
    const auto k = static_cast<std::size_t>(std::min(parts - 1, static_cast<int>(turn * parts)));
    out.sin[k] += sin_[i];
    out.cos[k] += cos_[i];
    out.count[k] += 1.0;
    squares += sin_[i] * sin_[i] + cos_[i] * cos_[i];
  }
  for (std::size_t k = 0; k < out.count.size(); ++k) {
    const double n = std::max(1.0, out.count[k]);
    squares -= (out.sin[k] * out.sin[k] + out.cos[k] * out.cos[k]) / n;
    out.sin[k] /= n;
    out.cos[k] /= n;
  }
  out.variance = std::max(squares, 0.0) / (2.0 * static_cast<double>(alpha_.size()));
  return out;
}

/// Mean square difference of the two patterns in units of its variance, over the parts that both
/// records have; infinite where these are less than half of the turn.
double ReferenceZero::misfit(const Pattern &mine, const ReferenceZero &other,
                             double moved_rad) const {
  const Pattern theirs = other.pattern(moved_rad);
  double sum = 0.0, parts = 0.0;
  for (std::size_t k = 0; k < mine.count.size(); ++k) {
    if (mine.count[k] < criteria::kFewestReadings || theirs.count[k] < criteria::kFewestReadings)
      continue;
    const double variance = mine.variance / mine.count[k] + theirs.variance / theirs.count[k];
    sum += (std::pow(mine.sin[k] - theirs.sin[k], 2) + std::pow(mine.cos[k] - theirs.cos[k], 2)) /
           std::max(variance, criteria::kLeastMeanSquare);
    parts += 2.0;
  }
  return parts < static_cast<double>(mine.count.size()) ? std::numeric_limits<double>::infinity()
                                                        : sum / parts;
}

namespace {

/// Whether one of two misfits is the better one, by the ratio of their likelihoods where the better
/// one tells how well any would do.
bool is_clearly_less(double one, double other, double parts) {
  return parts * (other - one) / std::max(1.0, one) > 2.0 * criteria::kRivalNats;
}

} // namespace

double ReferenceZero::best_period(const Pattern &mine, const ReferenceZero &other,
                                  double moved_rad) const {
  if (periods_ > criteria::kMostPeriodsInTurns)
    return moved_rad;
  const double parts = 2.0 * static_cast<double>(mine.count.size());
  double best = moved_rad, least = misfit(mine, other, moved_rad);
  for (int k = 1; k < periods_; ++k) {
    const double turned = moved_rad + k * kTwoPi / periods_;
    const double now = misfit(mine, other, turned);
    if (std::isfinite(least) && is_clearly_less(now, least, parts)) {
      least = now;
      best = turned;
    }
  }
  return best;
}

double ReferenceZero::move_of(const ReferenceZero &other) const {
  return best_period(pattern(0.0), other, other.zero_rad_ - zero_rad_);
}

double ReferenceZero::period_of(const ReferenceZero &other) const {
  return best_period(pattern(0.0), other, 0.0);
}

double ReferenceZero::move_if_needed(const ReferenceZero &other) const {
  const Pattern mine = pattern(0.0);
  const double moved = best_period(mine, other, other.zero_rad_ - zero_rad_);
  const double stays = misfit(mine, other, 0.0), moves = misfit(mine, other, moved);
  return std::isfinite(stays) &&
                 is_clearly_less(moves, stays, 2.0 * static_cast<double>(mine.count.size()))
             ? moved
             : 0.0;
}

namespace {

/// Slips where one capture ends and the next begins, as near as the noise tells a moment.
bool is_at_seam(const EffectInstance &e, const Capture &joined, double noise_rad, double period_s) {
  if (!is_jump(e.effect->info()))
    return false;
  // So many samples on the other side of a step change the likelihood too little to tell.
  const double steps = e.values[1] * kRadPerDeg / noise_rad;
  const double about =
      period_s * std::max(criteria::kFewestReadings,
                          2.0 * criteria::kRivalNats / std::max(steps * steps, 1e-12));
  return std::any_of(joined.starts.begin(), joined.starts.end(), [&](std::size_t start) {
    return start != 0 && e.values[0] > joined.time_s[start - 1] - about &&
           e.values[0] < joined.time_s[start] + about;
  });
}

/// Mean of the residual across the vector, rad of the shaft, and its number of samples.
struct Across {
  double sum = 0.0, samples = 0.0;
  double mean() const { return sum / std::max(samples, 1.0); }
};

std::vector<Across> across_by_capture(const Scene &scene, const Capture &joined,
                                      const Model &model) {
  const Observations &all = scene.all;
  const ResidualColumns r = residual_columns(all, model);
  std::vector<Across> out(joined.starts.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const double s = r.model_sin[i] - all.centre_sin_v, c = r.model_cos[i] - all.centre_cos_v;
    Across &of = out[capture_at(joined, all.time[i])];
    of.sum += (r.sin[i] * c - r.cos[i] * s) / std::max(s * s + c * c, 1e-12) / scene.periods;
    of.samples += 1.0;
  }
  return out;
}

} // namespace

std::size_t capture_at(const Capture &joined, double time_s) {
  std::size_t k = joined.starts.size() - 1;
  while (k > 0 &&
         time_s < 0.5 * (joined.time_s[joined.starts[k] - 1] + joined.time_s[joined.starts[k]]))
    --k;
  return k;
}

bool move_zeros(Scene &scene, const Capture &joined, const Model &found, double noise_v) {
  if (joined.starts.size() < 2)
    return false;
  const double noise_rad = noise_v / (std::abs(found.baseline.amplitude_v) * scene.periods);
  Model model = found;
  bool any = std::erase_if(model.effects, [&](const EffectInstance &e) {
               return is_at_seam(e, joined, noise_rad, scene.all.frame_period_s);
             }) > 0;
  const std::vector<Across> across = across_by_capture(scene, joined, model);
  std::vector<double> move(across.size(), 0.0);
  for (std::size_t k = 1; k < across.size(); ++k) {
    if (across[k].samples == 0.0 || across[0].samples == 0.0)
      continue;
    move[k] = across[k].mean() - across[0].mean();
    const double steps = move[k] / noise_rad;
    const double nats = 0.5 * steps * steps / (1.0 / across[k].samples + 1.0 / across[0].samples);
    any = any || (std::abs(steps) > criteria::kLeastOfNoise && nats > criteria::kRivalNats);
  }
  if (!any)
    return false;
  for (Observations *o : {&scene.all, &scene.spiked, &scene.rough, &scene.bursts})
    for (std::size_t i = 0; i < o->size(); ++i) {
      const double by = move[capture_at(joined, o->time[i])];
      o->alpha[i] += by;
      if (!o->moved.empty())
        o->moved[i] += static_cast<float>(by);
    }
  return true;
}

} // namespace ada
