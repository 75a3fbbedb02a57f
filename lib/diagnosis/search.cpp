// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/search.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/candidates.h"
#include "diagnosis/criteria.h"
#include "diagnosis/doubt.h"
#include "diagnosis/moments.h"
#include "diagnosis/onset.h"

namespace ada {

namespace {

constexpr std::size_t kQuick = 16000; ///< samples for looking around
constexpr std::size_t kCoarse = 6000; ///< samples for a first fit
constexpr std::size_t kShortlist = 5; ///< candidates that get a joint fit
constexpr int kMostEffects = 10;
/// A cause must be worth this many nats on held-out data, and more for each coordinate.
constexpr double kLeastNats = 12.0, kNatsPerCoordinate = 3.0;
/// What every pair has need only be likelier than not by this, beside what has no name.
constexpr double kExpectedNats = 0.0;
/// A moment that was looked for among all samples costs about the logarithm of their number.
constexpr double kNatsPerMoment = 11.0;
/// ... and explain at least this part of the noise: below it nobody would care.
constexpr double kLeastOfNoise = 0.06;
/// Residual, in units of the noise, above which what was found is called into question.
constexpr double kShaken = 1.25;
constexpr std::size_t kMostShaken = 6; ///< beyond so many the work grows too long
/// Two causes this correlated are one and the same in the data: both together would cancel each
/// other at sizes that mean nothing.
constexpr double kEntangled = 0.995;
/// ... unless far more is gained than by chance: two speeds just tell two lags apart.
constexpr double kNearlyOne = 0.999, kFarMoreNats = 1000.0;
/// Part of the best worth from which on another candidate does about as well.
constexpr double kAsWell = 0.98;
/// A rival that comes this close cannot be rejected.
constexpr double kRivalNats = 8.0;
/// What a cause leaves over of the one that yields to it, as a part of what either explains.
constexpr double kSlight = 0.02;
/// ... and as a part of the noise: what stands clear of it tells the two apart.
constexpr double kHidden = 0.5;
/// Prior cost of a motion whose own ripple happens to look like an error of the reference, nats.
constexpr double kCoincidence = 20.0;

std::size_t coordinates(const EffectInstance &e) {
  return e.effect->to_coordinates(e.values).size();
}

/// What an effect must be worth on held-out data beyond kLeastNats, for the freedom that it has.
double price(const EffectInstance &e) {
  double nats = kNatsPerCoordinate * static_cast<double>(coordinates(e));
  for (const ParameterInfo &p : e.effect->info().parameters)
    if (p.role == Role::chosen && p.unit == "s")
      nats += kNatsPerMoment;
  return nats;
}

/// Part of the noise that an effect must explain. One that may come at any order or frequency meets
/// every small imperfection of the rest.
double least_of_noise(const Effect &effect) {
  for (const ParameterInfo &p : effect.info().parameters)
    if (p.name == "order" || p.name == "frequency_hz")
      return 2.5 * kLeastOfNoise;
  return kLeastOfNoise;
}

/// Whether it is a function of the angle alone. A ripple of the motion is one, too, and what that is
/// to second order nobody knows.
bool of_the_angle(const Effect &effect) {
  return is_static(effect) || effect.info().stage == Stage::motion;
}

/// Whether it lets VTEMP follow VCOS.
bool leaks(const EffectInstance &e) {
  return e.effect->vtemp_on_vcos(e.values) != 0.0;
}

/// How far the leak of VCOS into VTEMP is from what the model makes it, in standard errors.
double leak_left(const SearchData &data, const Model &model) {
  const Observations &train = data.train;
  if (train.vtemp_on_vcos_error <= 0.0)
    return 0.0;
  return (train.vtemp_on_vcos - vtemp_on_vcos(model)) / train.vtemp_on_vcos_error;
}

bool leak_unexplained(const SearchData &data, const Model &model) {
  return 0.5 * leak_left(data, model) * leak_left(data, model) > kLeastNats;
}

/// Log likelihood of what stands beside the pair: VTEMP and the motion of the reference.
double side_evidence(const SearchData &data, const Model &model) {
  double sum = -0.5 * leak_left(data, model) * leak_left(data, model);
  std::array<double, 2> ripple{0.0, 0.0};
  for (const EffectInstance &e : model.effects) {
    const auto part = e.effect->reference_ripple(e.values);
    ripple[0] += part[0];
    ripple[1] += part[1];
  }
  if (data.scene->reference_ripple_error > 0.0) {
    // The reference's own error must show against a smooth motion, unless the motion ripples so.
    const double dc = data.scene->reference_cos - ripple[0];
    const double ds = data.scene->reference_sin - ripple[1];
    const double z2 = (dc * dc + ds * ds) /
                      (data.scene->reference_ripple_error * data.scene->reference_ripple_error);
    sum -= std::min(0.5 * z2, kCoincidence);
  }
  return sum;
}

} // namespace

void SearchResult::forget(std::size_t place) {
  const auto drop = [](auto &from, std::size_t at) {
    from.erase(from.begin() + static_cast<std::ptrdiff_t>(at));
  };
  const std::size_t effect = order[place];
  drop(fit.model.effects, effect);
  drop(order, place);
  drop(contribution, place);
  drop(alternatives, place);
  for (std::size_t &k : order)
    k -= k > effect;
}

Search::Search(SearchData data, Model baseline, double noise_v, Report report)
    : data_(std::move(data)), baseline_(std::move(baseline)), given_(baseline_.effects.size()),
      noise_v_(noise_v), report_(std::move(report)) {
  std::vector<std::uint32_t> indices(data_.train.size());
  for (std::size_t i = 0; i < indices.size(); ++i)
    indices[i] = static_cast<std::uint32_t>(i);
  quick_ = data_.train.select(thin(indices, kQuick));
  coarse_ = data_.train.select(thin(indices, kCoarse));
}

double Search::log_likelihood(const FitResult &fit, double heldout) const {
  const double n = static_cast<double>(data_.heldout.size());
  // The variance is that of the data that judge, as everywhere: they may differ from the training
  // data in more than noise, and a fit makes those look quieter than they are.
  const double variance = std::max(heldout / (2.0 * n), criteria::kLeastMeanSquare);
  return n * (std::log(data_.heldout.weight_along) - std::log(kTwoPi * variance)) -
         0.5 * heldout / variance + side_evidence(data_, fit.model);
}

Search::State Search::evaluate(const Model &start, int iterations) const {
  // A thin part brings the fit near the end; what is not converged would look like a gain of
  // whatever is tried next.
  State out;
  out.fit = fit(data_.train,
                data_.train.coloured ? start : fit(coarse_, start, iterations).model,
                data_.train.coloured ? iterations : 5);
  out.judged =
      data_.judge == data_.scene ? out.fit.model : as_seen_by(data_.heldout, out.fit.model);
  out.heldout = sum_of_squares(data_.heldout, out.judged);
  out.score = log_likelihood(out.fit, out.heldout);
  return out;
}

double Search::contribution(const State &with, const State &less) const {
  return std::sqrt(std::max(0.0, less.heldout - with.heldout) /
                   (2.0 * static_cast<double>(data_.heldout.size())));
}

/// The same in volts as they are, however residuals are weighed.
double Search::volts_explained(const State &with, const State &less) const {
  if (data_.heldout.weight_along == 1.0)
    return contribution(with, less);
  Observations plain = data_.heldout;
  plain.weight_along = 1.0;
  const double fall = sum_of_squares(plain, less.judged) - sum_of_squares(plain, with.judged);
  return std::max(contribution(with, less),
                  std::sqrt(std::max(0.0, fall) / (2.0 * static_cast<double>(plain.size()))));
}

/// How much an effect moves a channel with everything else unchanged, V rms: what other causes can
/// take over is still in it.
double Search::reach(const Model &model, std::size_t effect) const {
  Model less = model;
  less.effects.erase(less.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  const ResidualColumns a = residual_columns(quick_, model), b = residual_columns(quick_, less);
  double sum = 0.0;
  for (std::size_t i = 0; i < a.sin.size(); ++i) {
    const double s = a.sin[i] - b.sin[i], c = a.cos[i] - b.cos[i];
    sum += s * s + c * c;
  }
  return std::sqrt(sum / (2.0 * static_cast<double>(a.sin.size())));
}

/// What each effect moves beyond the baseline's own freedom (offsets, amplitude and zero), V^2:
/// products of each with each, means of a channel.
Eigen::MatrixXd Search::own_moves(const Model &model) const {
  const auto n = static_cast<Eigen::Index>(model.effects.size());
  const ResidualColumns all = residual_columns(coarse_, model);
  const auto samples = static_cast<Eigen::Index>(coarse_.size());
  Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(2 * samples, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    if (model.effects[static_cast<std::size_t>(k)].effect->info().evidence != Evidence::signal)
      continue;
    Model less = model;
    less.effects.erase(less.effects.begin() + k);
    const ResidualColumns rest = residuals_alone(coarse_, less);
    for (Eigen::Index i = 0; i < samples; ++i) {
      const auto at = static_cast<std::size_t>(i);
      moved(2 * i, k) = rest.sin[at] - all.sin[at];
      moved(2 * i + 1, k) = rest.cos[at] - all.cos[at];
    }
  }
  Eigen::MatrixXd free(2 * samples, 4);
  for (Eigen::Index i = 0; i < samples; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double y = all.model_sin[at] - coarse_.centre_sin_v;
    const double x = all.model_cos[at] - coarse_.centre_cos_v;
    free.row(2 * i) << 1.0, 0.0, y, x;
    free.row(2 * i + 1) << 0.0, 1.0, x, -y;
  }
  const Eigen::MatrixXd onto = free.transpose() * moved;
  const Eigen::Matrix4d within = free.transpose() * free;
  return (moved.transpose() * moved - onto.transpose() * within.ldlt().solve(onto)) /
         (2.0 * static_cast<double>(samples));
}

/// Whether an effect stands by itself: it is no larger than what there is to explain, and no other
/// cancels it.
bool Search::stands_alone(const Eigen::MatrixXd &own, std::size_t effect) const {
  const auto k = static_cast<Eigen::Index>(effect);
  const auto square = [](double v) { return v * v; };
  if (own(k, k) > square(criteria::kMostOfDiscrepancy * discrepancy_v_))
    return false;
  for (Eigen::Index j = 0; j < own.rows(); ++j)
    if (j != k && own(k, k) + own(j, j) + 2.0 * own(j, k) <
                      square(criteria::kLeastOfPair) * std::max(own(j, j), own(k, k)))
      return false;
  return true;
}

bool Search::all_stand_alone(const Model &model) const {
  const Eigen::MatrixXd own = own_moves(model);
  for (std::size_t k = given_; k < model.effects.size(); ++k)
    if (!stands_alone(own, k))
      return false;
  return true;
}

/// What an effect explains, V rms: no more than it moves, and where the evidence stands beside the
/// pair all of that.
double Search::size_of(const State &with, const State &less, std::size_t effect) const {
  const double moved = reach(with.fit.model, effect);
  if (data_.train.coloured) // what it gains counts against what has no name, and not against noise
    return moved;
  const EffectInstance &e = with.fit.model.effects[effect];
  if (leak_unexplained(data_, less.fit.model) &&
      (leaks(e) || !leak_unexplained(data_, with.fit.model)))
    return moved;
  return std::min(volts_explained(with, less), moved);
}

Search::State Search::without(const State &now, std::size_t effect) const {
  Model model = now.fit.model;
  model.effects.erase(model.effects.begin() + static_cast<std::ptrdiff_t>(effect));
  return evaluate(model, 4);
}

/// What an effect must explain beyond what is not known to second order, V rms: a coarse
/// converter's error is no noise, and looks like a little of many effects.
double Search::doubt_v(const Model &model) const {
  constexpr double kOfStep = 0.1;
  return std::max(second_order(*data_.scene, quick_, model), kOfStep * data_.scene->coarse_step_v);
}

/// The model with what every pair has, absent as yet: it is fitted from the start, and goes when
/// nothing speaks for it.
Model Search::with_expected(Model model) const {
  for (const Effect *effect : catalogue())
    if (effect->info().prior_rank == 0 &&
        std::none_of(model.effects.begin(), model.effects.end(),
                     [&](const EffectInstance &e) { return e.effect == effect; }))
      model.effects.push_back(
          {effect, std::vector<double>(effect->info().parameters.size(), 0.0), {}});
  return model;
}

/// What every pair has is expected: it need only stand out of what has no name. Anything else is
/// looked for among many.
bool Search::worth_keeping(double worth, const Effect &effect) const {
  const bool expected = data_.train.coloured && effect.info().prior_rank == 0;
  return worth > (expected ? kExpectedNats : kLeastNats);
}

/// A true cause makes no part of the record worse: one that helps here at the cost of there stands
/// for something that comes and goes. Judged in stretches that each are worth so much that chance
/// makes none of them worse, and hold whole turns.
bool Search::helps_everywhere(const State &with, const State &less) const {
  const Observations &data = data_.heldout;
  const ResidualColumns a = residual_columns(data, with.judged), b = residual_columns(data, less.judged);
  std::vector<double> gain(data.size());
  double left = 0.0;
  for (std::size_t i = 0; i < data.size(); ++i) {
    double as = a.sin[i], ac = a.cos[i], bs = b.sin[i], bc = b.cos[i];
    data.whiten(i, a.model_sin[i], a.model_cos[i], as, ac);
    data.whiten(i, b.model_sin[i], b.model_cos[i], bs, bc);
    left += as * as + ac * ac;
    gain[i] = bs * bs + bc * bc - as * as - ac * ac;
  }
  const double n = static_cast<double>(data.size());
  const double nats = std::accumulate(gain.begin(), gain.end(), 0.0) * n /
                      std::max(left, criteria::kLeastMeanSquare * n);
  const double turns = n / static_cast<double>(std::max<std::size_t>(1, data_.scene->all.size())) *
                       data_.scene->turns;
  const auto stretches = static_cast<std::size_t>(std::max(
      0.0, std::min({criteria::kMostStretchesOfGain, nats / criteria::kNatsOfStretch,
                     turns / criteria::kTurnsOfStretch})));
  if (stretches < criteria::kFewestStretchesOfGain)
    return true;
  std::vector<double> of_stretch(stretches, 0.0);
  for (std::size_t i = 0; i < data.size(); ++i)
    of_stretch[i * stretches / data.size()] += gain[i];
  double better = 0.0, worse = 0.0;
  for (double g : of_stretch)
    (g > 0.0 ? better : worse) += std::abs(g);
  return worse < criteria::kMostHarm * better;
}

/// What nobody knows of the residual, V rms of a channel.
double Search::unknown_v(const State &now) const {
  const double rss = white_sum_of_squares(data_.train, now.fit.model);
  const double noise = std::max(noise_v_, data_.scene->white_noise_v);
  return std::sqrt(
      std::max(0.0, rss / (2.0 * static_cast<double>(data_.train.size())) - noise * noise));
}

/// Whether what was measured rules an effect out as it was fitted.
bool Search::refuted(const State &state, std::size_t effect) const {
  const Model &model = state.fit.model;
  const ResidualColumns columns = residual_columns(quick_, model);
  const Residual view = residual_view(*data_.scene, quick_, columns, data_.scene->white_noise_v,
                                      model.baseline.amplitude_v);
  return model.effects[effect].effect->refuted(model.effects[effect].values, view);
}

/// A signature describes one term of what repeats with the angle. It is worth a name of its own while
/// it holds more than all the terms smaller than it together.
bool Search::dominates(double size_v, std::size_t effect, const Model &model) const {
  if (unnamed_v2_ <= 0.0)
    return true;
  double rest = unnamed_v2_ - size_v * size_v;
  for (std::size_t k = 0; k < model.effects.size(); ++k)
    if (k != effect && model.effects[k].effect->info().signature)
      if (const double other = reach(model, k); other > size_v)
        rest -= other * other;
  return size_v * size_v > rest;
}

bool Search::forward(State &now) {
  const double allowance = doubt_v(now.fit.model);
  const std::vector<Candidate> list = candidates(*data_.scene, quick_, now.fit.model, {.signatures = signatures_});
  const double scale = static_cast<double>(data_.train.size()) / static_cast<double>(quick_.size());
  const double variance = now.fit.rss / (2.0 * static_cast<double>(data_.train.size()));
  struct Option {
    State state;
    const Effect *effect;
    double worth;
  };
  const bool unexplained = leak_unexplained(data_, now.fit.model);
  std::vector<Option> options;
  std::size_t physical = 0, signatures = 0;
  for (const Candidate &c : list) {
    // What stands beside the pair may ask for a cause that the pair alone hardly shows.
    const bool asked_for = unexplained && leaks(c.start.effects.back());
    if (!worth_keeping(scale * c.gain / (2.0 * variance), *c.effect) && !asked_for)
      continue;
    std::size_t &count = c.effect->info().signature ? signatures : physical;
    if (count >= (c.effect->info().signature ? 2 : kShortlist) && !asked_for)
      continue;
    ++count;
    State state = evaluate(with_exact_moments(*data_.scene, c.start, c.start.effects.size() - 1));
    if (!state.fit.determined || !in_range(state.fit.model, given_))
      continue;
    const std::size_t last = state.fit.model.effects.size() - 1;
    if (refuted(state, last) || !all_stand_alone(state.fit.model))
      continue;
    if (has_moment(*c.effect) && !begins_at_once(*data_.scene, state.fit.model, last))
      continue;
    const double worth = state.score - now.score - price(c.start.effects.back());
    const bool clear = worth > kFarMoreNats && !c.effect->info().signature;
    if (!worth_keeping(worth, *c.effect) ||
        entanglement(state.fit, last, given_) > (clear ? kNearlyOne : kEntangled))
      continue;
    const double size = size_of(state, now, last);
    if (c.effect->info().signature && !dominates(size, last, state.fit.model))
      continue;
    if (size < least_of_noise(*c.effect) * noise_v_ || size < allowance ||
        !helps_everywhere(state, now))
      continue;
    options.push_back({std::move(state), c.effect, worth});
  }
  if (options.empty())
    return false;
  std::stable_sort(options.begin(), options.end(),
                   [](const Option &a, const Option &b) { return a.worth > b.worth; });
  // Of those that do about as well the one goes first that is likelier before any data. While much
  // else is left over, a small part of what they explain tells nothing.
  const Option *chosen = &options.front();
  const double noise = std::max(noise_v_, data_.scene->white_noise_v);
  const double as_well =
      unknown_v(options.front().state) > criteria::kOfUnknown * noise ? kAsWell : 1.0;
  for (const Option &o : options)
    if (o.worth > as_well * options.front().worth - kRivalNats &&
        o.effect->info().prior_rank < chosen->effect->info().prior_rank)
      chosen = &o;
  now = chosen->state;
  return true;
}

/// Choices that no search for a place decides, such as where a transfer is straight, are tried both
/// ways.
void Search::choose(State &now, std::size_t effect) const {
  const EffectInstance e = now.fit.model.effects[effect];
  for (auto &values : e.effect->choices(e.values)) {
    Model model = now.fit.model;
    model.effects[effect].values = std::move(values);
    State other = evaluate(model);
    if (other.fit.determined && other.score > now.score + kNatsPerCoordinate)
      now = std::move(other);
  }
}

bool Search::backward(State &now) {
  bool changed = false;
  for (std::size_t k = now.fit.model.effects.size(); k-- > given_;) {
    State less = without(now, k);
    const double worth = now.score - less.score - price(now.fit.model.effects[k]);
    const Effect &effect = *now.fit.model.effects[k].effect;
    const double size = size_of(now, less, k);
    const Eigen::MatrixXd own = own_moves(now.fit.model);
    const auto at = static_cast<Eigen::Index>(k);
    const double own_v = std::sqrt(std::max(0.0, own(at, at)));
    const bool possible =
        in_range(now.fit.model.effects[k]) && !refuted(now, k) && stands_alone(own, k);
    const bool worth_it = possible && worth_keeping(worth, effect) &&
                          (!effect.info().signature || dominates(size, k, now.fit.model)) && size > least_of_noise(effect) * noise_v_ &&
                          size > doubt_v(less.fit.model) &&
                          (effect.info().prior_rank == 0 || // expected, and not the likeliest of many
                           std::min(size, own_v) > criteria::kOfUnknown * unknown_v(now)) &&
                          helps_everywhere(now, less);
    if (worth_it)
      continue;
    now = std::move(less);
    changed = true;
  }
  return changed;
}

std::vector<Rival> Search::rivals(const State &now, std::size_t effect, State *better) const {
  std::vector<Rival> out;
  const State less = without(now, effect);
  const Effect *self = now.fit.model.effects[effect].effect;
  const double part = contribution(now, less);
  // A rival of the same leading shape differs in its higher terms only, which the order of the
  // stages blurs: what those can leave over is no reason to reject it.
  const double n = static_cast<double>(data_.heldout.size());
  const Baseline &base = now.fit.model.baseline;
  const double offset = std::hypot(base.offset_sin_v, base.offset_cos_v);
  const std::vector<Candidate> list =
      candidates(*data_.scene, quick_, less.fit.model,
                 {.signatures = signatures_, .invisible = !data_.scene->has_reference});
  const double my_side = side_evidence(data_, now.fit.model);
  const double in_transfer = offsets_in_transfer(quick_, now.fit.model);
  // Which of two stages acts first is not known to second order.
  const double others = sizes_at_rest(*data_.scene, quick_, less.fit.model).sum();
  const double noise = std::max(noise_v_, data_.scene->white_noise_v);
  double highest = 0.0;
  for (const Candidate &c : list)
    if (c.effect == self)
      highest = c.gain;
  if (highest == 0.0 && !list.empty())
    highest = list.front().gain;
  for (const Candidate &c : list) {
    if (c.effect == self || c.gain < 0.8 * highest)
      continue;
    // A signature is no rival of a physical cause; without a reference nothing tells them apart.
    if (c.effect->info().signature && !self->info().signature && data_.scene->has_reference)
      continue;
    State rival = evaluate(with_exact_moments(*data_.scene, c.start, c.start.effects.size() - 1));
    choose(rival, rival.fit.model.effects.size() - 1);
    const bool at_rest = of_the_angle(*self) && of_the_angle(*c.effect);
    if (!rival.fit.determined || !in_range(rival.fit.model, given_) ||
        !all_stand_alone(rival.fit.model) ||
        refuted(rival, rival.fit.model.effects.size() - 1))
      continue;
    const double side = side_evidence(data_, rival.fit.model) - my_side;
    // Beside what has no name the variance of that covers what is not known to second order.
    const double blurred =
        at_rest && !data_.train.coloured ? std::max({std::min(4.0 * part * (part + offset) / base.amplitude_v, 0.3 * part),
                            in_transfer, 4.0 * part * others / base.amplitude_v})
                : 0.0;
    const double left = std::sqrt(std::max(0.0, rival.heldout - now.heldout) / (2.0 * n));
    if (side < -kRivalNats || (rival.score - side < now.score - kRivalNats && left > blurred))
      continue;
    out.push_back({std::string(c.effect->info().id), rival.fit.model});
    const double saved =
        price(now.fit.model.effects[effect]) - price(rival.fit.model.effects.back());
    const bool yields = self->info().yields_to == c.effect->info().id;
    const double needed = yields ? -kRivalNats : kRivalNats;
    if (better && c.visible && saved >= 0.0 &&
        (rival.score + saved > now.score + needed ||
         c.effect->info().prior_rank < self->info().prior_rank ||
         (yields && left <= std::min({blurred, kSlight * part, kHidden * noise}))) &&
        (!c.effect->info().signature || self->info().signature) &&
        (better->score == 0.0 || rival.score > better->score))
      *better = std::move(rival);
  }
  return out;
}

bool Search::sideways(State &now) {
  for (std::size_t k = given_; k < now.fit.model.effects.size(); ++k) {
    State better{};
    known_rivals_[{now.score, k}] = rivals(now, k, &better);
    if (better.score != 0.0) {
      now = std::move(better);
      return true;
    }
  }
  return false;
}

/// Forward until nothing more is confirmed.
void Search::climb(State &now) {
  while (now.fit.model.effects.size() < given_ + kMostEffects) {
    progress("searching for a cause");
    if (notice_supply(now))
      continue;
    if (!forward(now))
      break;
    weigh_anew(now);
    for (std::size_t k = given_; k < now.fit.model.effects.size(); ++k)
      choose(now, k);
  }
}

/// What was found first, with everything else still in the residual, and what has a moment of its
/// own.
std::vector<std::size_t> Search::suspects(const State &now) const {
  constexpr std::size_t kFirst = 2, kMost = 3;
  std::vector<std::size_t> out;
  for (std::size_t k = given_; k < now.fit.model.effects.size() && out.size() < kMost; ++k)
    if (now.fit.model.effects[k].effect->info().prior_rank > 0 &&
        (out.size() < kFirst || has_moment(*now.fit.model.effects[k].effect)))
      out.push_back(k);
  return out;
}

/// A cause found early, while others were still mixed into the residual, may be a wrong one that
/// hides the right ones. Where much is left over, the suspects are given up in turn and the search
/// goes on from there.
bool Search::shake(State &now) {
  if (shaken_)
    return false;
  const double rms = std::sqrt(now.fit.rss / (2.0 * static_cast<double>(data_.train.size())));
  if (rms < kShaken * std::max(noise_v_, data_.scene->white_noise_v) ||
      now.fit.model.effects.size() > given_ + kMostShaken)
    return false;
  const auto value = [&](const State &s) {
    double v = s.score;
    for (std::size_t k = given_; k < s.fit.model.effects.size(); ++k)
      v -= price(s.fit.model.effects[k]);
    return v;
  };
  State best = now;
  const bool rejected = std::exchange(supply_rejected_, true); // weights stay as they are
  for (std::size_t k : suspects(now)) {
    State other = without(now, k);
    climb(other);
    backward(other);
    if (value(other) > value(best) + kRivalNats)
      best = std::move(other);
  }
  supply_rejected_ = rejected;
  shaken_ = best.score == now.score;
  if (shaken_)
    return false;
  now = std::move(best);
  return true;
}

void Search::progress(const char *what) {
  ++steps_;
  if (report_)
    report_(1.0 - 1.0 / (1.0 + 0.25 * steps_), what);
}

SearchResult Search::run(bool thorough, const Model *found, double unnamed_v2) {
  progress("fitting the baseline");
  unnamed_v2_ = unnamed_v2;
  // A signature is named only where no physical cause explains as much: those come first.
  signatures_ = found != nullptr;
  measure_discrepancy();
  State now = evaluate(found ? *found : baseline_, 12);
  weigh_motion(now);
  bool swapped = false;
  for (int round = 0; round < 4; ++round) {
    climb(now);
    progress("dropping what is not needed");
    const bool dropped = backward(now);
    if (!thorough)
      break;
    progress("comparing rivals");
    swapped = sideways(now);
    if (!dropped && !swapped && !shake(now) && !doubt_supply(now))
      break;
  }
  settle_supply(now);
  // What followed a supply, or what a last step sideways left behind, loses its ground.
  if (swapped || data_.train.disturbed == Direction::supply)
    while (backward(now)) {
    }
  return result(now, thorough);
}

/// What the baseline leaves over, V rms of a channel.
void Search::measure_discrepancy() {
  const Model model = fit(coarse_, baseline_, 12).model;
  discrepancy_v_ = std::sqrt(white_sum_of_squares(coarse_, model) /
                             (2.0 * static_cast<double>(coarse_.size())));
}

void Search::colour(const Discrepancy &discrepancy) {
  // Beside a discrepancy the number of samples is not what limits the errors.
  constexpr std::size_t kEnough = 4000;
  for (Observations *o : {&data_.train, &data_.heldout}) {
    std::vector<std::uint32_t> indices(o->size());
    std::iota(indices.begin(), indices.end(), 0u);
    o->keep(thin(indices, kEnough, 100));
  }
  quick_ = data_.train;
  for (Observations *o : {&data_.train, &data_.heldout})
    o->coloured = std::make_shared<Coloured>(discrepancy, *o);
  quick_.coloured = data_.train.coloured;
}

SearchResult Search::run_against(const Discrepancy &discrepancy, double unnamed_v2,
                                 const Model &found) {
  measure_discrepancy();
  colour(discrepancy);
  supply_rejected_ = true;
  shaken_ = false;
  signatures_ = true;
  unnamed_v2_ = unnamed_v2;
  State now = evaluate(with_expected(found), 12);
  for (int round = 0; round < 3; ++round) {
    progress("comparing with what has no name");
    const bool dropped = backward(now);
    const std::size_t before = now.fit.model.effects.size();
    climb(now);
    const bool swapped = sideways(now);
    if (!dropped && !swapped && now.fit.model.effects.size() == before && !shake(now))
      break;
  }
  // Each time with one cause less: what is left is judged without those gone, and what every pair has
  // is asked for again.
  while (backward(now)) {
  }
  now = evaluate(with_expected(now.fit.model), 12);
  while (backward(now)) {
  }
  return result(now, true);
}

SearchResult Search::result(State &now, bool thorough) {
  SearchResult out;
  const std::size_t n = now.fit.model.effects.size();
  std::vector<std::pair<double, std::size_t>> size;
  for (std::size_t k = given_; k < n; ++k) {
    progress("weighing a finding");
    const State less = without(now, k);
    size.emplace_back(contribution(now, less), k);
  }
  std::sort(size.rbegin(), size.rend());
  for (const auto &[part, k] : size) {
    out.order.push_back(k);
    out.contribution.push_back(part);
    const auto known = known_rivals_.find({now.score, k});
    out.alternatives.push_back(!thorough                     ? std::vector<Rival>{}
                               : known != known_rivals_.end() ? known->second
                                                              : rivals(now, k, nullptr));
  }
  out.residual_rms_v = std::sqrt(now.fit.rss / (2.0 * static_cast<double>(data_.train.size())));
  out.fit = std::move(now.fit);
  out.supply_rms_fraction = supply_rms_fraction_;
  out.disturbed = data_.train.disturbed;
  out.weight_along = data_.train.weight_along;
  return out;
}

} // namespace ada
