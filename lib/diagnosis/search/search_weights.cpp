// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// How the search weighs residuals: a supply that is not recorded moves both outputs along the
// absolute voltages, a motion that is known from the pair alone moves them along the figure.

#include <algorithm>
#include <array>
#include <cmath>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/criteria.h"
#include "diagnosis/noise/along_and_across.h"
#include "diagnosis/search/search.h"

namespace ada {

namespace {

/// Weight of the residual along a supply that is not recorded, while causes are looked for.
constexpr double kShareInSearch = 0.15;
/// A supply turns with the absolute voltages. Where a fixed direction leaves no more than this over
/// of what lies across them, it may as well be an offset that wanders.
constexpr double kTurns = 1.02;
/// A supply knows nothing of the angle. Where more of it repeats with the turn it is something
/// else.
constexpr double kRepeats = 0.5;
/// It moves the length of the vector as well. Where that has less than this part of what it should
/// have, only the angle is off.
constexpr double kOfLength = 0.5;

} // namespace

/// Residual variance along and across the pair of absolute voltages, which is how a supply that is
/// not recorded moves both outputs.
Search::AlongSupply Search::along_supply(const State &now) const {
  const ResidualColumns r = residual_columns(data_.train, now.fit.model);
  constexpr std::size_t kBins = 36;
  std::array<double, kBins> sum{}, count{};
  AlongSupply out;
  double ss = 0.0, sc = 0.0, cc = 0.0;
  // Spikes are no supply: what lies too far across is one.
  constexpr double kStandsOut = 6.0;
  std::vector<double> across(r.sin.size());
  for (std::size_t i = 0; i < across.size(); ++i)
    across[i] = std::abs(r.sin[i] * r.model_cos[i] - r.cos[i] * r.model_sin[i]) /
                std::hypot(r.model_sin[i], r.model_cos[i]);
  const double most = kStandsOut * quantile(across, 0.6827);
  double n = 0.0;
  for (std::size_t i = 0; i < r.sin.size(); ++i) {
    if (across[i] > most)
      continue;
    n += 1.0;
    const double vs = r.model_sin[i], vc = r.model_cos[i];
    const double l2 = vs * vs + vc * vc;
    const double a = (r.sin[i] * vs + r.cos[i] * vc), b = (r.sin[i] * vc - r.cos[i] * vs);
    const double ys = vs - data_.train.centre_sin_v, yc = vc - data_.train.centre_cos_v;
    const double y2 = std::max(ys * ys + yc * yc, 1e-300);
    out.length_v2 += std::pow(r.sin[i] * ys + r.cos[i] * yc, 2) / y2;
    out.of_length += std::pow(vs * ys + vc * yc, 2) / (y2 * l2);
    const double turn = wrap(data_.train.alpha[i], kTwoPi) / kTwoPi * static_cast<double>(kBins);
    const std::size_t bin = std::min(kBins - 1, static_cast<std::size_t>(turn));
    sum[bin] += a / std::sqrt(l2);
    count[bin] += 1.0;
    out.along += a * a / l2;
    out.across += b * b / l2;
    out.length2 += l2;
    ss += r.sin[i] * r.sin[i];
    sc += r.sin[i] * r.cos[i];
    cc += r.cos[i] * r.cos[i];
  }
  for (std::size_t b = 0; b < kBins; ++b)
    out.repeats += count[b] > 0.0 ? sum[b] * sum[b] / count[b] : 0.0;
  out.repeats /= std::max(out.along, 1e-300);
  out.along /= n;
  out.across /= n;
  out.length2 /= n;
  out.length_v2 /= n;
  out.of_length /= n;
  out.fixed = (0.5 * (ss + cc) - std::hypot(0.5 * (ss - cc), sc)) / n;
  return out;
}

/// Whether what lies along the absolute voltages turns with them, knows nothing of the angle and
/// moves the length as they do.
bool Search::AlongSupply::is_supply() const {
  return fixed > kTurns * across && repeats < kRepeats &&
         length_v2 - across > kOfLength * of_length * (along - across);
}

/// Weighs the residual along the absolute voltages by what lies across them, until both agree;
/// `share` less while causes are looked for: a supply wanders slowly, and what follows it a little
/// way would seem to be borne out by many samples.
Search::AlongSupply Search::weigh_supply(State &now, double share) {
  AlongSupply part = along_supply(now);
  for (int pass = 0; pass < 4; ++pass) {
    const double across = std::max(part.across, noise_v_ * noise_v_);
    weigh(now, Direction::supply, share * std::sqrt(across / part.along));
    part = along_supply(now);
  }
  return part;
}

/// A residual that lies mainly along the absolute voltages is weighed as that of a supply, first to
/// see whether the rest of the model then comes out clean.
bool Search::notice_supply(State &now) {
  // Beside the angle that a pair gives itself anything that moves the radius looks like a supply.
  if (supply_rms_fraction_ > 0.0 || supply_rejected_ || !data_.train.supply.empty() ||
      data_.scene->radius_only || now.fit.model.effects.size() == looked_at_with_)
    return false;
  if (!data_.scene->has_reference)
    return notice_supply_in_radius(now);
  const double noise2 = noise_v_ * noise_v_;
  AlongSupply part = along_supply(now);
  if (part.along < 1.5 * noise2 || part.along < 1.3 * part.across ||
      part.along - part.across < 0.5 * noise2 || !part.is_supply())
    return false;
  const State before = now;
  part = weigh_supply(now, kShareInSearch);
  const bool clean =
      part.across < criteria::kClean * noise2 && part.along - part.across > 0.5 * noise2;
  if (!clean && part.along < 4.0 * part.across) {
    weigh(now, Direction::none, 1.0);
    now = before;
    looked_at_with_ = now.fit.model.effects.size(); // with more found it may come out clean
    return false;
  }
  supply_rms_fraction_ = std::sqrt((part.along - part.across) / part.length2);
  return true;
}

/// With everything else found, is it still a supply?
bool Search::doubt_supply(State &now) {
  if (supply_rms_fraction_ <= 0.0)
    return false;
  const double noise2 = noise_v_ * noise_v_;
  if (data_.scene->has_reference) {
    const AlongSupply part = weigh_supply(now, 1.0);
    if (part.across < criteria::kClean * noise2 && part.along - part.across > 0.5 * noise2 &&
        part.is_supply()) {
      supply_rms_fraction_ = std::sqrt((part.along - part.across) / part.length2);
      return false;
    }
    weigh(now, Direction::none, 1.0);
  } else {
    supply_rms_fraction_ = 0.0;
    if (notice_supply_in_radius(now))
      return false;
  }
  supply_rms_fraction_ = 0.0;
  supply_rejected_ = true;
  return true;
}

/// Without a reference only the radius tells: its variance then follows the square of the part of
/// the absolute voltages that lies along the radius, which no other cause does.
bool Search::notice_supply_in_radius(State &now) {
  const ResidualColumns r = residual_columns(data_.train, now.fit.model);
  double n = 0.0, g1 = 0.0, g2 = 0.0, v1 = 0.0, gv = 0.0, v2 = 0.0;
  for (std::size_t i = 0; i < r.sin.size(); ++i) {
    const double s = r.model_sin[i] - data_.train.centre_sin_v,
                 c = r.model_cos[i] - data_.train.centre_cos_v;
    const double inverse = 1.0 / std::hypot(s, c);
    const double radial = (r.sin[i] * s + r.cos[i] * c) * inverse;
    const double reach = (data_.train.vsin[i] * s + data_.train.vcos[i] * c) * inverse;
    const double v = radial * radial, g = reach * reach;
    n += 1.0;
    g1 += g;
    g2 += g * g;
    v1 += v;
    v2 += v * v;
    gv += g * v;
  }
  const double slope = (n * gv - g1 * v1) / (n * g2 - g1 * g1);
  const double intercept = (v1 - slope * g1) / n;
  const double noise2 = noise_v_ * noise_v_;
  // What is no number shows no supply.
  const bool shown = slope > 0.0 && slope * g1 / n >= 0.5 * noise2 && intercept <= 2.0 * noise2 &&
                     intercept >= -0.3 * slope * g1 / n;
  if (!shown)
    return false;
  supply_rms_fraction_ = std::sqrt(slope);
  return true;
}

void Search::weigh(State &now, Direction direction, double weight) {
  for (Observations *o : {&data_.train, &data_.heldout, &quick_, &coarse_}) {
    o->disturbed = direction;
    o->weight_along = weight;
  }
  forget();
  now = evaluate(now.fit.model, 4);
}

/// Without a reference the smooth motion is itself an estimate. What the true motion does beyond it
/// lies along the circle, so that direction weighs as much as its own scatter allows. So does what
/// a reference errs by in each row for itself.
void Search::weigh_motion(State &now) {
  if (data_.scene->radius_only || data_.train.disturbed == Direction::supply)
    return;
  if (data_.scene->has_reference) {
    constexpr int kPasses = 4; // each tells the figure the better by the length
    for (int pass = 0; data_.scene->reference_errs && pass < kPasses; ++pass)
      weigh(now, Direction::motion, part_of_reference(now.fit.model));
    return;
  }
  data_.train.disturbed = Direction::motion;
  const ResidualColumns r = residual_columns(data_.train, now.fit.model);
  double along = 0.0, across = 0.0;
  for (std::size_t i = 0; i < r.sin.size(); ++i) {
    const auto [us, uc] = data_.train.direction_at(i, r.model_sin[i], r.model_cos[i]);
    const double a = r.sin[i] * us + r.cos[i] * uc, b = r.sin[i] * uc - r.cos[i] * us;
    along += a * a;
    across += b * b;
  }
  weigh(now, Direction::motion, std::min(1.0, std::sqrt(across / along)));
}

/// What lies out of the figure over what lies along it, rms, of what differs from row to row: in
/// second differences what goes smoothly with the angle is small. No more than 1.
double Search::part_of_reference(const Model &model) const {
  const Observations &all = data_.scene->all;
  std::vector<double> out, along;
  along_and_across(all, residual_columns(all, model), out, along);
  double out2 = 0.0, along2 = 0.0;
  for (std::size_t i = 2; i < all.size(); ++i) {
    out2 += std::pow(out[i] - 2.0 * out[i - 1] + out[i - 2], 2);
    along2 += std::pow(along[i] - 2.0 * along[i - 1] + along[i - 2], 2);
  }
  return along2 > out2 ? std::sqrt(out2 / along2) : 1.0;
}

void Search::weigh_anew(State &now) {
  if (data_.train.disturbed == Direction::supply)
    weigh_supply(now, kShareInSearch);
  else
    weigh_motion(now);
}

/// In the end a supply has its full weight, and must still be one.
void Search::settle_supply(State &now) {
  if (data_.train.disturbed != Direction::supply)
    return;
  const AlongSupply part = weigh_supply(now, 1.0);
  const double more = part.along - part.across;
  supply_rms_fraction_ =
      more > 0.5 * noise_v_ * noise_v_ && part.is_supply() ? std::sqrt(more / part.length2) : 0.0;
  if (supply_rms_fraction_ == 0.0)
    weigh(now, Direction::none, 1.0);
}

} // namespace ada
