// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/noise/random_causes.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numeric>
#include <optional>
#include <utility>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/criteria.h"
#include "diagnosis/noise/along_and_across.h"
#include "diagnosis/noise/flicker.h"

namespace ada {

namespace {

const Effect *effect_of(Evidence evidence, std::string_view axis, Pattern pattern,
                        Character character) {
  for (const Effect *effect : catalogue()) {
    const EffectInfo &info = effect->info();
    if (info.evidence == evidence && info.axis == axis && info.pattern == pattern &&
        info.character == character)
      return effect;
  }
  return nullptr;
}

/// Held-out mean square that a set of columns takes, and the nats that it is worth.
struct Worth {
  double share_v2 = 0.0, nats = 0.0;
};

Worth worth_of(const Anonymous &left, Pattern pattern) {
  const Selection &all = left.selection;
  const Eigen::Index last = left.from.heldout.rows() - 1;
  // Without the columns in question, the others as they are.
  Eigen::VectorXd values = Eigen::VectorXd::Zero(last), less = values;
  for (std::size_t k = 0; k < all.columns.size(); ++k) {
    const double value = all.values[static_cast<Eigen::Index>(k)];
    values[all.columns[k]] = value;
    less[all.columns[k]] = is_course_of(left, all.columns[k], pattern) ? 0.0 : value;
  }
  const auto square = [&](const Eigen::VectorXd &v) {
    const auto &g = left.from.heldout;
    return (g(last, last) - 2.0 * v.dot(g.col(last).head(last)) +
            v.dot(g.topLeftCorner(last, last) * v)) /
           left.from.n_heldout;
  };
  const double with = std::max(square(values), criteria::kLeastMeanSquare), without = square(less);
  return {without - with, 0.5 * left.from.told() * std::log(without / with)};
}

/// Course of one complex coefficient over the record, at `steps` even times.
std::vector<std::complex<double>> course_of(const Anonymous &left, int exponent) {
  constexpr int kSteps = 200;
  std::vector<std::complex<double>> out(kSteps);
  const Selection &all = left.selection;
  for (std::size_t k = 0; k + 1 < all.columns.size(); k += 2) {
    const auto group = static_cast<std::size_t>(all.columns[k] / 2);
    const Basis::Term &term = left.basis.terms()[group];
    if (term.modulation.kind != Modulation::trend || term.exponent != exponent)
      continue;
    const std::complex<double> c(all.values[static_cast<Eigen::Index>(k)],
                                 all.values[static_cast<Eigen::Index>(k + 1)]);
    for (int i = 0; i < kSteps; ++i)
      out[static_cast<std::size_t>(i)] +=
          c * std::cos(0.5 * kTwoPi * term.modulation.order * (i + 0.5) / kSteps);
  }
  return out;
}

double rms(const std::vector<std::complex<double>> &course, bool imaginary) {
  double sum = 0.0;
  for (const auto &c : course)
    sum += imaginary ? c.imag() * c.imag() : c.real() * c.real();
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, course.size())));
}

/// Components of the residual of every sample along and across the vector, with what has no name
/// taken out.
struct Shape {
  std::vector<double> along, across, omega, radius;
  double stretched; ///< as stretched_by_split has it
  ResidualColumns rest;
  Observations data;
};

Shape shape_of(const Anonymous &left, const DataSplit &split, const Model &model) {
  Shape out;
  std::vector<std::uint32_t> all(split.train.size());
  std::iota(all.begin(), all.end(), 0u);
  out.data = split.train.select(thin(all, criteria::kAnonymousTrain, 400));
  out.data.coloured.reset();
  const std::vector<char> passes = where_outputs_pass(out.data, model);
  std::vector<std::uint32_t> passing;
  for (std::size_t i = 0; i < passes.size(); ++i)
    if (passes[i])
      passing.push_back(static_cast<std::uint32_t>(i));
  out.data.keep(passing);
  out.rest = residual_columns(out.data, model);
  along_and_across(out.data, out.rest, out.along, out.across);
  subtract(left.basis, left.selection, out.data, out.rest);
  std::vector<double> along, across;
  along_and_across(out.data, out.rest, along, across);
  // What has no name is chosen by what it takes out in all. Where it adds to one direction of the
  // two, it belongs to the other.
  if (mean_square(along) < mean_square(out.along))
    out.along = std::move(along);
  if (mean_square(across) < mean_square(out.across))
    out.across = std::move(across);
  out.stretched = stretched_by_axes(out.data, out.rest);
  for (std::size_t i = 0; i < out.data.size(); ++i) {
    out.omega.push_back(out.data.omega[i]);
    out.radius.push_back(std::max(std::hypot(out.rest.model_sin[i] - out.data.centre_sin_v,
                                             out.rest.model_cos[i] - out.data.centre_cos_v),
                                  1e-12));
  }
  return out;
}

/// White part of a column: half the mean square of first differences, which slow structure does not
/// enter, trimmed of the few largest, which may be spikes.
double white_variance(const std::vector<double> &x) {
  // Of a normal variable cut at +-q, where 98 % lie (q = 2.326, density 0.02665): the variance of
  // what stays, 1 - 2 q 0.02665 / 0.98 of the whole.
  constexpr double kKept = 0.98, kStays = 0.8735;
  std::vector<double> d;
  for (std::size_t i = 1; i < x.size(); ++i)
    d.push_back((x[i] - x[i - 1]) * (x[i] - x[i - 1]));
  if (d.empty())
    return 0.0;
  const auto keep = static_cast<std::size_t>(kKept * static_cast<double>(d.size()));
  std::nth_element(d.begin(), d.begin() + static_cast<std::ptrdiff_t>(keep), d.end());
  const double sum = std::accumulate(d.begin(), d.begin() + static_cast<std::ptrdiff_t>(keep), 0.0);
  return 0.5 * sum / static_cast<double>(keep) / kStays;
}

/// White part of a column, where what is fast in it is white, whatever else is in it that is slow:
/// first and third differences tell one variance, each to a few times the error of a mean square,
/// and the smaller is that of the noise; third differences further apart than they reach have
/// nothing in common, as those of a tone have. Nothing: it is not.
std::optional<double> white_where_fast(const std::vector<double> &x) {
  constexpr double kSquares = 20.0; // of the weights 1, -3, 3, -1
  constexpr double kErrors = 6.0, kStandsOut = 4.0, kInCommon = 0.1;
  constexpr std::size_t kReach = 3, kFurthest = 12; // rows
  std::vector<double> third;
  for (std::size_t i = 3; i < x.size(); ++i)
    third.push_back(x[i] - 3.0 * x[i - 1] + 3.0 * x[i - 2] - x[i - 3]);
  if (third.size() < 2 * kFurthest)
    return std::nullopt;
  const double n = static_cast<double>(third.size()), spread = robust_spread(third);
  const double faster = spread * spread / kSquares, fast = white_variance(x);
  const double most = criteria::kAlmostWhite + kErrors * std::sqrt(2.0 / n);
  if (fast > most * faster || faster > most * fast)
    return std::nullopt;
  for (double &v : third)
    v = std::clamp(v, -kStandsOut * spread, kStandsOut * spread);
  const double power = mean_square(third) * n;
  for (std::size_t lag = kReach + 1; lag <= kFurthest; ++lag) {
    double common = 0.0;
    for (std::size_t i = lag; i < third.size(); ++i)
      common += third[i] * third[i - lag];
    if (std::abs(common) > (kInCommon + kErrors / std::sqrt(n)) * power)
      return std::nullopt;
  }
  return std::min(fast, faster);
}

/// What noise of the recorded temperature and supply there is in what is left, V^2 along the vector
/// and across it: a pair that follows what is recorded is right with it, and one that does not is
/// off by it.
struct OfConditions {
  double along_v2 = 0.0, across_v2 = 0.0;
};

/// Of a column of the residual that goes against what a recorded one moves, the variance that does:
/// by regression of third differences from row to row, in which neither what is slow has a part nor
/// a ripple of many rows. A pair that follows leaves a slope of 0, one that does not of -1.
double against(const std::vector<double> &left, const std::vector<double> &moves,
               const std::vector<float> &recorded) {
  constexpr double kSigmas = 5.0;   // e^-12 by chance, as elsewhere
  constexpr double kSquares = 20.0; // of the weights 1, -3, 3, -1
  constexpr double kTogether = 2.3; // products of such differences are worth so many times fewer
  const auto third = [](const auto &v, std::size_t i) {
    return static_cast<double>(v[i]) - 3.0 * static_cast<double>(v[i - 1]) +
           3.0 * static_cast<double>(v[i - 2]) - static_cast<double>(v[i - 3]);
  };
  double xx = 0.0, xy = 0.0, yy = 0.0, n = 0.0;
  for (std::size_t i = 3; i < left.size(); ++i, n += 1.0) {
    const double x = 0.5 * (moves[i - 1] + moves[i - 2]) * third(recorded, i), y = third(left, i);
    xx += x * x;
    xy += x * y;
    yy += y * y;
  }
  if (xx <= 0.0 || xy >= 0.0 || xy * xy * n < kSigmas * kSigmas * kTogether * xx * yy)
    return 0.0;
  const double slope = std::max(-1.0, xy / xx);
  return slope * slope * xx / (kSquares * n);
}

OfConditions noise_of_conditions(const Observations *in_order, const Model &model) {
  OfConditions out;
  if (!in_order || (in_order->temp.empty() && in_order->supply.empty()))
    return out;
  std::vector<std::uint32_t> rows(std::min(in_order->size(), criteria::kFlickerRows));
  std::iota(rows.begin(), rows.end(),
            static_cast<std::uint32_t>((in_order->size() - rows.size()) / 2));
  Observations data = in_order->select(rows);
  data.coloured.reset();
  const ResidualColumns rest = residual_columns(data, model);
  std::vector<double> along, across;
  along_and_across(data, rest, along, across);
  for (auto column : {&Observations::temp, &Observations::supply}) {
    const std::vector<float> recorded = data.*column;
    if (recorded.empty())
      continue;
    const double by =
        std::sqrt(white_variance(std::vector<double>(recorded.begin(), recorded.end())));
    if (!(by > 0.0))
      continue;
    // In place: of a long record this is where most is in memory.
    for (float &v : data.*column)
      v += static_cast<float>(by);
    ResidualColumns moves = residual_columns(data, model);
    data.*column = recorded;
    for (std::size_t i = 0; i < moves.sin.size(); ++i) {
      moves.sin[i] =
          (std::exchange(moves.model_sin[i], rest.model_sin[i]) - rest.model_sin[i]) / by;
      moves.cos[i] =
          (std::exchange(moves.model_cos[i], rest.model_cos[i]) - rest.model_cos[i]) / by;
    }
    std::vector<double> along_of, across_of;
    along_and_across(data, moves, along_of, across_of);
    out.along_v2 += against(along, along_of, recorded);
    out.across_v2 += against(across, across_of, recorded);
  }
  return out;
}

/// Nats by which two variances are better than one, of n values each.
double nats_of_two(double a, double b, double n) {
  const double both = 0.5 * (a + b);
  return 0.5 * n * (2.0 * std::log(both) - std::log(a) - std::log(b));
}

/// Across noise that grows with the speed against one that does not: sum of squares explained.
struct Growth {
  double fixed, per_speed2; ///< variance = fixed + per_speed2 (omega radius)^2
  double nats;              ///< of the growing over the fixed one
};

Growth growth_of(const Shape &shape, double along, int periods) {
  // One line through many squares: weighted by nothing, which is enough to tell the two apart.
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t i = 0; i < shape.across.size(); ++i) {
    const double x = std::pow(shape.omega[i] * periods * shape.radius[i], 2);
    const double y = shape.across[i] * shape.across[i];
    n += 1.0;
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const double d = n * sxx - sx * sx;
  Growth out{sy / n, 0.0, 0.0};
  if (d <= 0.0 || sxx <= 0.0)
    return out;
  // Beside the noise that the vector has along it, too, either all of the rest grows or none.
  const double slope = std::max(0.0, (sxy - along * sx) / sxx);
  double grows = 0.0, fixed = 0.0;
  const double constant = std::max(sy / n, 1e-300);
  for (std::size_t i = 0; i < shape.across.size(); ++i) {
    const double x = std::pow(shape.omega[i] * periods * shape.radius[i], 2);
    const double y = shape.across[i] * shape.across[i];
    const double variance = std::max(along + slope * x, 1e-300);
    grows -= 0.5 * (std::log(variance) + y / variance);
    fixed -= 0.5 * (std::log(constant) + y / constant);
  }
  return {constant, slope, grows - fixed};
}

std::string id_of(const Effect *effect) {
  return effect ? std::string(effect->info().id) : std::string();
}

} // namespace

bool is_course_of(const Anonymous &left, Eigen::Index column, Pattern pattern) {
  const auto group = static_cast<std::size_t>(column / 2);
  if (left.basis.terms()[group].modulation.kind != Modulation::trend)
    return false;
  const int m = left.basis.terms()[group].exponent;
  return pattern == Pattern::offset ? m == 0 : m == left.basis.periods() && column % 2 == 0;
}

double crosstalk(double periods, double waves) {
  return criteria::kLittle *
         std::min(1.0, criteria::kPeriodsPerTrend * waves / std::max(periods, 1e-9));
}

namespace {

/// Nats by which the radius of held-out data is likelier with a course of this pattern than
/// without.
double radial_nats(const Anonymous &left, const DataSplit &split, const Model &model,
                   Pattern pattern) {
  const Observations own = at_own_angle(split.heldout, model);
  const ResidualColumns as_it_is = residual_columns(own, model);
  Selection less = left.selection;
  for (std::size_t k = 0; k < less.columns.size(); ++k)
    if (is_course_of(left, less.columns[k], pattern))
      less.values[static_cast<Eigen::Index>(k)] = 0.0;
  const auto left_v2 = [&](const Selection &selection) {
    ResidualColumns rest = as_it_is;
    subtract(left.basis, selection, own, rest);
    keep_radial(own, rest);
    return std::max(mean_square(rest.sin) + mean_square(rest.cos), criteria::kLeastMeanSquare);
  };
  return 0.5 * static_cast<double>(own.size()) * std::log(left_v2(less) / left_v2(left.selection));
}

} // namespace

std::vector<RandomCause> slow_causes(const Anonymous &left, const DataSplit &split,
                                     const Model &model, double periods, bool counts) {
  std::vector<RandomCause> out;
  const double noise2 = left.selection.noise_v2;
  if (left.selection.orders[static_cast<std::size_t>(Axis::time)] == 0)
    return out;
  const double waves = left.selection.orders[static_cast<std::size_t>(Axis::time)];
  const double relative = 1.0 / std::sqrt(2.0 * std::max(1.0, waves)); // of an rms of so many terms
  const Worth offset = worth_of(left, Pattern::offset), gain = worth_of(left, Pattern::gain);
  const double both_v2 = offset.share_v2 + gain.share_v2;
  // Without a reference what is slow along the circle may be a motion that was followed badly, as
  // where a shaft turns back, and so may it be between the steps of one that counts: then the
  // radius must have it, too.
  const auto clear = [&](const Worth &w, Pattern pattern) {
    return w.nats > criteria::kNatsOfNoise &&
           ((split.has_reference && !counts) ||
            radial_nats(left, split, model, pattern) > criteria::kNatsOfNoise) &&
           w.share_v2 > criteria::kWorthAWord * criteria::kWorthAWord * noise2 &&
           w.share_v2 > crosstalk(periods, waves) * both_v2;
  };
  const double word_v = criteria::kWorthAWord * std::sqrt(noise2);
  const Effect *offset_effect =
      effect_of(Evidence::process, "time", Pattern::offset, Character::process);
  const auto offset_course = course_of(left, 0);
  const double sin = rms(offset_course, true), cos = rms(offset_course, false);
  if (offset_effect && clear(offset, Pattern::offset) && std::max(sin, cos) > word_v) {
    out.push_back({offset_effect,
                   {sin, cos},
                   {relative * sin, relative * cos},
                   {},
                   offset.nats,
                   0.5 * (sin * sin + cos * cos)});
  }
  const Effect *gain_effect =
      effect_of(Evidence::process, "time", Pattern::gain, Character::process);
  const double grown_v = rms(course_of(left, model.periods_per_turn), false);
  if (gain_effect && clear(gain, Pattern::gain) && grown_v > word_v) {
    const double fraction = grown_v / std::abs(model.baseline.amplitude_v);
    out.push_back(
        {gain_effect, {fraction}, {relative * fraction}, {}, gain.nats, 0.5 * grown_v * grown_v});
  }
  // A supply that nobody recorded moves the offsets and the gain by one and the same wave.
  if (out.size() == 2 && split.train.supply.empty()) {
    const auto o = course_of(left, 0), g = course_of(left, model.periods_per_turn);
    double og = 0.0, oo = 0.0, gg = 0.0;
    for (std::size_t i = 0; i < o.size(); ++i) {
      const double common = (o[i].real() + o[i].imag()) / std::sqrt(2.0);
      og += common * g[i].real();
      oo += common * common;
      gg += g[i].real() * g[i].real();
    }
    if (og > criteria::kSameWave * std::sqrt(oo * gg))
      for (RandomCause &c : out)
        c.alternatives.push_back(std::string(the_effect(follows_supply).info().id));
  }
  return out;
}

std::vector<RandomCause> noise_causes(const Anonymous &left, const DataSplit &split,
                                      const Model &model, const NoiseSeen &seen) {
  const auto &[stated_v, step_rad, lines_across, in_order, even_clock] = seen;
  std::vector<RandomCause> out;
  const Shape shape = shape_of(left, split, model);
  const double n = static_cast<double>(shape.along.size());
  if (n < criteria::kFewestForNoise)
    return out;
  // What goes on from sample to sample is no noise of these kinds.
  const auto white = [](const std::vector<double> &x) {
    double steps = 0.0;
    for (std::size_t i = 1; i < x.size(); ++i)
      steps += (x[i] - x[i - 1]) * (x[i] - x[i - 1]);
    return mean_square(x) <
           criteria::kAlmostWhite * 0.5 * steps / static_cast<double>(x.size() - 1);
  };
  const auto own = [](double v2, double of_conditions) {
    return std::max(v2 - of_conditions, criteria::kLeastMeanSquare);
  };
  const OfConditions recorded = noise_of_conditions(in_order, model);
  const double along = own(white_variance(shape.along), recorded.along_v2);
  const double amplitude = model.baseline.amplitude_v;
  // The steps of a reference lie across the vector, too.
  const double steps_v2 = std::pow(step_rad * model.periods_per_turn * amplitude, 2) / 12.0;
  const double of_steps = steps_v2 * criteria::kOfSteps;
  const double all_across =
      own(white_variance(shape.across) * (1.0 - lines_across), recorded.across_v2);
  const double across = std::max(std::min(all_across, along), all_across - of_steps);
  const bool differ = nats_of_two(along, across, n / 2.0) > criteria::kNatsOfNoise &&
                      std::max(along, across) > criteria::kMoreVariance * std::min(along, across);
  // A variance from differences of n samples is known to this part (von Neumann, Ann. Math. Stat.
  // 12, 1941).
  const double relative_error = std::sqrt(3.0 / n);
  const double error_of_two = std::hypot(along, across) * relative_error;
  // Without a reference what lies across the vector may be the motion's, which makes it no less.
  struct {
    double v2 = 0.0, error_v2 = 0.0;
  } of_gain;
  constexpr double kSigmas = 5.0; // e^-12 by chance, as elsewhere
  if (!split.own_angle) {
    if (differ && along > across)
      of_gain = {along - across, error_of_two};
  } else if (in_order && in_order->frame_period_s > 0.0) {
    if (const auto seen_v2 = by_differences(*in_order, model);
        seen_v2 && seen_v2->gain_v2 - recorded.along_v2 > kSigmas * seen_v2->gain_error_v2 &&
        seen_v2->gain_v2 - recorded.along_v2 > (criteria::kMoreVariance - 1.0) * seen_v2->along_v2)
      of_gain = {seen_v2->gain_v2 - recorded.along_v2, seen_v2->gain_error_v2};
  }
  if (of_gain.v2 > 0.0 && white(shape.along)) {
    const double f = std::sqrt(of_gain.v2) / amplitude;
    const double error = of_gain.error_v2 / (2.0 * f * amplitude * amplitude);
    std::vector<std::string> others;
    if (split.train.supply.empty())
      others.push_back(std::string(the_effect(follows_supply).info().id));
    if (const Effect *e = effect_of(Evidence::noise, "noise", Pattern::gain, Character::white))
      out.push_back(
          {e, {f}, {error}, others, nats_of_two(along, along - of_gain.v2, n / 2.0), 0.0});
  }
  if (differ && across > along && split.has_reference && white(shape.across)) {
    const Effect *jitter = effect_of(Evidence::noise, "noise", Pattern::turn, Character::dynamic);
    const Effect *noise = effect_of(Evidence::noise, "noise", Pattern::turn, Character::white);
    const int p = model.periods_per_turn;
    const Growth growth = growth_of(shape, along, p);
    const double turn = std::sqrt(across - along) / amplitude / p;
    const double relative = error_of_two / (2.0 * (across - along));
    const double nats = nats_of_two(along, across, n / 2.0);
    if (jitter && growth.nats > criteria::kNatsOfNoise) {
      const double s = std::sqrt(growth.per_speed2);
      out.push_back({jitter, {s}, {relative * s}, {}, nats, 0.0});
    } else if (noise) {
      std::vector<std::string> others;
      if (jitter && growth.nats > -criteria::kNatsOfNoise)
        others.push_back(id_of(jitter));
      const double deg = turn * kDegPerRad;
      out.push_back({noise, {deg}, {relative * deg}, others, nats, 0.0});
    }
  }
  // What a reference rounds stays the same for as long as a slow shaft stays in one step: that
  // grows toward low frequency as well.
  const bool by_reference = split.has_reference && steps_v2 < along;
  Flicker flicker = even_clock ? flicker_of(*in_order, by_reference, model, left) : Flicker{};
  if (flicker.corner_hz > 0.0 && of_gain.v2 > 0.0) {
    // A noise of the gain is no noise of the channels, which the corner is against: along the
    // vector it shows whole, in a channel half.
    const double span = in_order->time.back() - in_order->time.front();
    const double channels = std::max(along - of_gain.v2, criteria::kLeastMeanSquare);
    const double higher = 1.0 + of_gain.v2 * (by_reference ? 0.5 : 1.0) / channels;
    const double octaves = std::max(std::log(flicker.corner_hz * span), 1.0);
    flicker.rms_v *= std::sqrt(1.0 + std::log(higher) / octaves);
    flicker.corner_hz *= higher;
  }
  if (flicker.corner_hz > 0.0)
    if (const Effect *e =
            effect_of(Evidence::noise, "noise", Pattern::offset, Character::process)) {
      constexpr double kOfCorner = 0.15, kOfRms = 0.1; // what octaves of a record let one tell
      out.push_back({e,
                     {flicker.rms_v, flicker.corner_hz},
                     {kOfRms * flicker.rms_v, kOfCorner * flicker.corner_hz},
                     {},
                     flicker.nats,
                     flicker.rms_v * flicker.rms_v});
    }
  // White noise shows in both directions alike; what is more along one of them has been named.
  const bool one = differ || !split.has_reference;
  double white2 = of_gain.v2 > 0.0       ? along - of_gain.v2
                  : !split.has_reference ? along
                  : differ               ? std::min(along, across)
                                         : 0.5 * (along + across);
  white2 /= shape.stretched;
  const Effect *excess = effect_of(Evidence::noise, "noise", Pattern::offset, Character::white);
  const bool by_across = along > across && !split.own_angle;
  const std::vector<double> &judged = by_across ? shape.across : shape.along;
  // Beside what goes on slowly and has no name what is fast tells, and it alone.
  const auto fast = stated_v > 0.0 ? white_where_fast(judged) : std::nullopt;
  const bool plain = white(judged);
  const bool is_white = fast && (plain || flicker.corner_hz <= 0.0);
  const double most = plain ? criteria::kMoreVariance : criteria::kTwiceAsMuch;
  if (!plain && fast)
    white2 = std::min(white2, *fast / shape.stretched);
  if (excess && is_white && white2 > most * stated_v * stated_v) {
    const double more = std::sqrt(white2 - stated_v * stated_v);
    const double ratio = white2 / (stated_v * stated_v);
    // What differences tell of a variance is worth fewer samples: 2 over the square of its error.
    const double samples = (one ? 1.0 : 2.0) * 2.0 / (relative_error * relative_error);
    const double nats = 0.5 * samples * (ratio - 1.0 - std::log(ratio));
    // Beside a noise of one direction alone the excess is read off the other one, where a noise of
    // that one would be as well.
    std::vector<std::string> others;
    if (differ && split.has_reference)
      if (const Effect *other =
              effect_of(Evidence::noise, "noise", across > along ? Pattern::gain : Pattern::turn,
                        Character::white))
        others.push_back(id_of(other));
    if (nats > criteria::kNatsOfNoise)
      out.push_back({excess,
                     {more},
                     {white2 * relative_error / std::sqrt(one ? 1.0 : 2.0) / (2.0 * more)},
                     others,
                     nats,
                     0.0});
  }
  return out;
}

void leave_to_flicker(std::vector<RandomCause> &slow, const std::vector<RandomCause> &noise,
                      int waves, double span_s) {
  const Effect *flicker = effect_of(Evidence::noise, "noise", Pattern::offset, Character::process);
  for (const RandomCause &n : noise) {
    if (n.effect != flicker || n.slow_v2 <= 0.0)
      continue;
    const double corner_hz = n.values[1];
    // A density s/f has s ln(corner span) below its corner, and s/k in the k-th half wave.
    double expected = 0.0;
    for (int k = 1; k <= waves; ++k)
      expected += n.slow_v2 / std::log(std::max(corner_hz * span_s, std::exp(1.0))) / k;
    std::erase_if(slow, [&](const RandomCause &c) {
      return c.effect->info().pattern == Pattern::offset &&
             c.slow_v2 < criteria::kOctaveOff * expected;
    });
  }
}

} // namespace ada
