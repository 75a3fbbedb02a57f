// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/search/search.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/criteria.h"
#include "diagnosis/events/change_points.h"
#include "diagnosis/search/admission.h"
#include "diagnosis/search/candidates.h"
#include "diagnosis/search/first_model.h"
#include "diagnosis/search/identifiability.h"

namespace ada {

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

void SearchResult::name_last(std::size_t place) {
  const auto move = [place](auto &of) {
    const auto at = of.begin() + static_cast<std::ptrdiff_t>(place);
    std::rotate(at, at + 1, of.end());
  };
  move(order);
  move(contribution);
  move(alternatives);
}

Search::Search(SearchData data, Model baseline, double noise_v, Report report)
    : data_(std::move(data)), baseline_(std::move(baseline)), given_(baseline_.effects.size()),
      noise_v_(noise_v), report_(std::move(report)) {
  std::vector<std::uint32_t> indices(data_.train.size());
  for (std::size_t i = 0; i < indices.size(); ++i)
    indices[i] = static_cast<std::uint32_t>(i);
  quick_ = data_.train.select(thin(indices, criteria::kQuick));
  coarse_ = data_.train.select(thin(indices, criteria::kCoarse));
}

double Search::log_likelihood(const FitResult &fit, double heldout) const {
  const double n = static_cast<double>(data_.heldout.size());
  // The variance is that of the data that judge, as everywhere: they may differ from the training
  // data in more than noise, and a fit makes those look quieter than they are.
  const double variance = std::max(heldout / (2.0 * n), criteria::kLeastMeanSquare);
  return n * (std::log(data_.heldout.weight_along) - std::log(kTwoPi * variance)) -
         0.5 * heldout / variance + side_evidence(data_, fit.model);
}

Search::Start Search::start_of(const Model &model, int iterations) {
  const Baseline &b = model.baseline;
  Start out{static_cast<std::uint64_t>(iterations)};
  const auto add = [&](double v) { out.push_back(std::bit_cast<std::uint64_t>(v)); };
  for (double v : {b.amplitude_v, b.offset_sin_v, b.offset_cos_v, b.angle_zero_deg})
    add(v);
  for (const EffectInstance &e : model.effects) {
    out.push_back(reinterpret_cast<std::uintptr_t>(e.effect));
    for (const std::vector<double> *of : {&e.values, &e.std_errors})
      for (double v : *of)
        add(v);
  }
  return out;
}

Search::State Search::evaluate(const Model &start, int iterations) const {
  Start key = start_of(start, iterations);
  if (const auto known = known_fits_.find(key); known != known_fits_.end())
    return known->second;
  return known_fits_.emplace(std::move(key), fitted(start, iterations)).first->second;
}

const std::vector<Candidate> &Search::candidates_beside(const Model &model, bool signatures) const {
  const auto key = std::pair{start_of(model, 0), signatures};
  if (const auto known = known_candidates_.find(key); known != known_candidates_.end())
    return known->second;
  return known_candidates_.emplace(key, candidates(*data_.scene, quick_, model, signatures))
      .first->second;
}

void Search::forget() const {
  by_place_.clear();
  known_fits_.clear();
  known_candidates_.clear();
}

Search::State Search::fitted(const Model &start, int iterations) const {
  State out;
  if (data_.train.coloured) {
    out.fit = fit(data_.train, start, iterations);
  } else {
    // A thin part brings the fit near the end. While what is left is far above the noise, the
    // number of samples is not what limits it; later, what is not converged would look like a gain
    // of whatever is tried next.
    out.fit = fit(coarse_, start, iterations);
    const double left = out.fit.rss / (2.0 * static_cast<double>(coarse_.size()));
    const double noise = criteria::kFarAboveNoise * std::max(noise_v_, data_.scene->white_noise_v);
    if (left < noise * noise)
      out.fit = fit(data_.train, out.fit.model, 5);
    else
      out.fit.rss *= static_cast<double>(data_.train.size()) / static_cast<double>(coarse_.size());
  }
  out.judged =
      data_.judge == data_.scene ? out.fit.model : as_seen_by(data_.heldout, out.fit.model);
  out.heldout = sum_of_squares(data_.heldout, out.judged);
  out.score = log_likelihood(out.fit, out.heldout);
  return out;
}

Search::State Search::without(const State &now, std::size_t effect) const {
  return evaluate(now.fit.model.without(effect), 4);
}

bool Search::forward(State &now) {
  const double allowance = doubt_v(now.fit.model);
  const double scale = static_cast<double>(data_.train.size()) / static_cast<double>(quick_.size());
  const double variance = now.fit.rss / (2.0 * static_cast<double>(data_.train.size()));
  struct Option {
    State state;
    const Effect *effect;
    double worth;
  };
  const bool unexplained = leak_unexplained(data_.train, now.fit.model);
  std::vector<Option> options;
  std::size_t physical = 0, signatures = 0;
  std::map<std::string_view, std::size_t> beyond_angle; // by axis
  // A signature waits for the physical causes, unless it says much more than the best of them: of
  // what that leaves, others take the parts that look like them. Without a reference the angle is
  // the pair's own, and what the pair is off by looks like harmonics.
  const bool may_come = signatures_ || data_.scene->has_reference;
  double most_physical = 0.0, accepted = 0.0;
  const std::vector<Candidate> &list = candidates_beside(now.fit.model, may_come);
  for (const Candidate &c : list)
    if (c.visible && !c.effect->info().signature)
      most_physical = std::max(most_physical, c.gain);
  for (const Candidate &c : list) {
    if (!c.visible || (!signatures_ && c.effect->info().signature &&
                       c.gain < criteria::kSaysMuchMore * most_physical))
      continue;
    if (c.gain < criteria::kFarLess * accepted) // it would not be the one that goes first
      continue;
    // What stands beside the pair may ask for a cause that the pair alone hardly shows.
    const bool asked_for = unexplained && leaks(c.start.effects.back());
    if (!worth_keeping(scale * c.gain / (2.0 * variance), *c.effect) && !asked_for)
      continue;
    std::size_t &count = c.effect->info().signature ? signatures : physical;
    // Much that repeats with the angle may fill the list: what shows on another axis has places of
    // its own.
    const bool of_axis = shows_beyond_angle(*c.effect) &&
                         beyond_angle[c.effect->info().axis]++ < criteria::kShortlistOfAxis;
    if (count >= (c.effect->info().signature ? 2 : criteria::kShortlist) && !asked_for && !of_axis)
      continue;
    ++count;
    State state = evaluate(with_exact_moments(*data_.scene, c.start, c.start.effects.size() - 1));
    if (!state.fit.determined || !in_range(state.fit.model, given_))
      continue;
    const std::size_t last = state.fit.model.effects.size() - 1;
    // One more may bend those before it into what was not measured.
    if (refuted(state, given_, last + 1) ||
        !(all_stand_alone(state.fit.model) || leaves_noise(state)))
      continue;
    if (the_records_could(state, last) || is_shape_of_event(state.fit.model, last) ||
        may_not_be_of_time(state, last))
      continue;
    const double worth = against_unnamed(state, now, last) - penalty(c.start.effects.back());
    const bool clear = worth > criteria::kFarMoreNats && !c.effect->info().signature;
    if (!worth_keeping(worth, *c.effect))
      continue;
    const double alike = canonical_correlation(state.fit, last, given_);
    if (alike > (clear ? criteria::kNearlyOne : criteria::kOneShape) && !adds_up(state.fit, last))
      continue;
    const double size = size_of(state, now, last);
    if (c.effect->info().signature && !dominates(size, last, state.fit.model))
      continue;
    if (size < least_of_noise(*c.effect) * noise_v_ ||
        !beyond_doubt(size, state.fit.model, last, allowance) || !helps_everywhere(state, now) ||
        !helps_both_channels(state, now, last) ||
        (has_moment(*c.effect) && !helps_in_each_direction(state, now)))
      continue;
    accepted = std::max(accepted, c.gain);
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
      unknown_v(options.front().state) > criteria::kOfUnknown * noise ? criteria::kAsWell : 1.0;
  for (const Option &o : options)
    if (o.worth > as_well * options.front().worth - criteria::kRivalNats &&
        o.effect->info().prior_rank < chosen->effect->info().prior_rank)
      chosen = &o;
  now = chosen->state;
  return true;
}

/// Where few rows judge, as of the stops of a table, they confirm no cause while others as large
/// are left over. What every pair has and one more are tried at once there, and of them stays what
/// is needed beside the rest.
bool Search::forward_together(State &now) {
  constexpr std::size_t kFewRows = 100; // that judge
  if (data_.heldout.size() > kFewRows)
    return false;
  const Model expected = with_expected(now.fit.model);
  State best;
  double most = value(now) + criteria::kLeastNats;
  std::size_t tried = 0;
  for (const Candidate &c : candidates_beside(now.fit.model, signatures_)) {
    if (!c.visible || c.effect->info().signature || !is_static(*c.effect) ||
        c.effect->info().prior_rank == 0)
      continue;
    if (++tried > criteria::kShortlist)
      break;
    Model start = expected;
    start.effects.push_back(c.start.effects.back());
    State state = evaluate(start);
    if (!state.fit.determined || !in_range(state.fit.model, given_) ||
        refuted(state, given_, state.fit.model.effects.size()) ||
        !all_stand_alone(state.fit.model) || value(state) <= most)
      continue;
    most = value(state);
    best = std::move(state);
  }
  if (best.fit.model.effects.empty())
    return false;
  backward(best);
  if (best.fit.model.effects.size() <= now.fit.model.effects.size() ||
      value(best) <= value(now) + criteria::kLeastNats)
    return false;
  now = std::move(best);
  return true;
}

bool Search::backward(State &now) {
  bool changed = false;
  for (std::size_t k = now.fit.model.effects.size(); k-- > given_;) {
    State less = without(now, k);
    const double worth = against_unnamed(now, less, k) - penalty(now.fit.model.effects[k]);
    const Effect &effect = *now.fit.model.effects[k].effect;
    const double size = size_of(now, less, k);
    const Eigen::MatrixXd own = own_moves(now.fit.model);
    const auto at = static_cast<Eigen::Index>(k);
    const double own_v = std::sqrt(std::max(0.0, own(at, at)));
    const bool possible = in_range(now.fit.model.effects[k]) && !refuted(now, k) &&
                          !the_records_could(now, k) && !is_shape_of_event(now.fit.model, k) &&
                          !may_not_be_of_time(now, k) &&
                          (stands_alone(own, k) || leaves_noise(now));
    const bool worth_it =
        possible && worth_keeping(worth, effect) &&
        (!effect.info().signature || dominates(size, k, now.fit.model)) &&
        size > least_of_noise(effect) * noise_v_ &&
        beyond_doubt(size, now.fit.model, k, doubt_v(less.fit.model)) &&
        (effect.info().prior_rank == 0 || // expected, and not the likeliest of many
         is_measured_aside(data_.train, now.fit.model, k) ||
         stands_out(now, k, std::min(size, own_v))) &&
        helps_everywhere(now, less) && helps_both_channels(now, less, k) &&
        (!has_moment(effect) || helps_in_each_direction(now, less));
    if (worth_it)
      continue;
    now = std::move(less);
    changed = true;
  }
  return changed;
}

/// Forward until nothing more is confirmed.
void Search::climb(State &now) {
  bool supply_seen = false; // once a climb, whatever becomes of it
  while (now.fit.model.effects.size() < given_ + criteria::kMostEffects) {
    progress("searching for a cause");
    if (!supply_seen && (supply_seen = notice_supply(now)))
      continue;
    if (!forward(now) && !forward_together(now))
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

/// What a step costs is paid by the whole model.
double Search::value(const State &state) const {
  double v = state.score;
  for (std::size_t k = given_; k < state.fit.model.effects.size(); ++k)
    v -= penalty(state.fit.model.effects[k]);
  return v;
}

/// Of two ways to read one effect that do as well, the one that needs less beside it: an offset
/// ahead of a bent transfer is a mismatch behind it.
bool Search::choose_simpler(State &now) {
  bool changed = false;
  for (std::size_t k = given_; k < now.fit.model.effects.size(); ++k) {
    const EffectInstance e = now.fit.model.effects[k];
    for (auto &values : e.effect->choices(e.values)) {
      Model model = now.fit.model;
      model.effects[k].values = std::move(values);
      State other = evaluate(model);
      backward(other);
      if (!other.fit.determined || value(other) <= value(now))
        continue;
      now = std::move(other);
      changed = true;
      break;
    }
    if (changed)
      break;
  }
  return changed;
}

/// Whether what repeats with the angle is shared between a physical cause and a signature: a
/// signature alone may need less.
bool Search::shared_with_signature(const Model &model) const {
  const auto any = [&](bool signature) {
    return std::any_of(model.effects.begin() + static_cast<std::ptrdiff_t>(given_),
                       model.effects.end(), [&](const EffectInstance &e) {
                         return e.effect->info().prior_rank > 0 && of_the_angle(*e.effect) &&
                                e.effect->info().signature == signature;
                       });
  };
  return any(true) && any(false);
}

/// Whether fewer causes do as well, up to what is not known to second order.
bool Search::needs_less(const State &fewer, const State &now) const {
  for (std::size_t k = given_; k < now.fit.model.effects.size(); ++k) {
    const Effect *effect = now.fit.model.effects[k].effect;
    const auto &others = fewer.fit.model.effects;
    if (shows_beyond_angle(*effect) &&
        std::none_of(others.begin(), others.end(),
                     [&](const auto &e) { return e.effect == effect; }))
      return false; // what is not known to second order repeats with the angle
  }
  const double more = std::max(0.0, fewer.heldout - now.heldout);
  return fewer.fit.determined && fewer.fit.model.effects.size() < now.fit.model.effects.size() &&
         std::sqrt(more / (2.0 * static_cast<double>(data_.heldout.size()))) <
             doubt_v(now.fit.model);
}

/// A cause found early, while others were still mixed into the residual, may be a wrong one that
/// hides the right ones. Where much is left over, the suspects are given up in turn and the search
/// goes on from there.
bool Search::exchange(State &now) {
  if (exchanged_)
    return false;
  const double rms = std::sqrt(now.fit.rss / (2.0 * static_cast<double>(data_.train.size())));
  // Beside what has no name, what that leaves over is the noise.
  const double rest_v = data_.train.coloured ? std::sqrt(data_.train.coloured->rest_v2()) : 0.0;
  const bool loud =
      rms >= criteria::kExchangeAbove * std::max({noise_v_, data_.scene->white_noise_v, rest_v});
  const bool shared = shared_with_signature(now.fit.model);
  if (!(loud || shared) || now.fit.model.effects.size() > given_ + criteria::kMostExchanged)
    return false;
  State best = now;
  const bool rejected = std::exchange(supply_rejected_, true); // weights stay as they are
  const auto from = [&](State other) {
    climb(other);
    backward(other);
    if (value(other) > value(best) + criteria::kRivalNats || needs_less(other, best))
      best = std::move(other);
  };
  const std::vector<std::size_t> given_up = suspects(now);
  for (std::size_t k : given_up)
    if (loud)
      from(without(now, k));
  // Several that share the work of one hide it from each other's absence. Begun anew, the search
  // takes the same way each time.
  if ((shared || given_up.size() > 1) && !std::exchange(begun_anew_, true))
    from(evaluate(with_expected(baseline_), 12));
  supply_rejected_ = rejected;
  exchanged_ = best.score == now.score;
  if (exchanged_)
    return false;
  now = std::move(best);
  return true;
}

void Search::progress(const char *what) {
  ++steps_;
  if (report_)
    report_(1.0 - 1.0 / (1.0 + 0.25 * steps_), what);
}

SearchResult Search::run(bool thorough, const Model *found, const Unnamed &unnamed,
                         const std::vector<EffectInstance> &seen) {
  progress("fitting the baseline");
  unnamed_ = unnamed;
  // A signature is named only where no physical cause explains as much: those come first.
  signatures_ = found != nullptr;
  measure_discrepancy();
  Model start = found ? *found : with_expected(baseline_);
  start.effects.insert(start.effects.end(), seen.begin(), seen.end());
  State now = evaluate(start, 12);
  weigh_motion(now);
  bool swapped = false;
  for (int round = 0; round < 4; ++round) {
    climb(now);
    progress("dropping what is not needed");
    const bool dropped = backward(now) || choose_simpler(now);
    if (!thorough)
      break;
    progress("comparing rivals");
    swapped = exchange_rivals(now);
    if (!dropped && !swapped && !exchange(now) && !doubt_supply(now))
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
  discrepancy_v_ =
      std::sqrt(white_sum_of_squares(coarse_, model) / (2.0 * static_cast<double>(coarse_.size())));
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
  forget();
}

namespace {

using Cause = std::pair<const Effect *, std::vector<double>>;

/// With what was chosen of each, an order or a channel, in an order that does not depend on how
/// they were found.
std::vector<Cause> causes_of(const Model &model) {
  std::vector<Cause> out;
  for (const EffectInstance &e : model.effects) {
    out.emplace_back(e.effect, std::vector<double>{});
    const auto parameters = e.effect->info().parameters;
    for (std::size_t k = 0; k < parameters.size(); ++k)
      if (parameters[k].role == Role::chosen)
        out.back().second.push_back(std::isfinite(e.values[k]) ? e.values[k] : -1.0);
  }
  std::sort(out.begin(), out.end());
  return out;
}

} // namespace

SearchResult Search::run_against(const Discrepancy &discrepancy, const Unnamed &unnamed,
                                 const Model &found) {
  measure_discrepancy();
  colour(discrepancy);
  supply_rejected_ = true;
  exchanged_ = false;
  signatures_ = true;
  unnamed_ = unnamed;
  State now = evaluate(with_expected(found), 12);
  std::set<std::vector<Cause>> been; // from the same causes the search goes much the same way
  for (int round = 0; round < 3; ++round) {
    progress("comparing with what has no name");
    const bool dropped = backward(now);
    if (!been.insert(causes_of(now.fit.model)).second)
      break;
    const std::size_t before = now.fit.model.effects.size();
    climb(now);
    const bool swapped = exchange_rivals(now);
    if (!dropped && !swapped && now.fit.model.effects.size() == before && !exchange(now))
      break;
  }
  // Each time with one cause less: what is left is judged without those gone, and what every pair
  // has is asked for again.
  while (backward(now)) {
  }
  const State before = now;
  now = evaluate(with_expected(now.fit.model), 12);
  while (backward(now)) {
  }
  // Where nothing came of it, what is known of the rivals stands.
  constexpr double kAsBefore = 0.01; // nats
  if (causes_of(now.fit.model) == causes_of(before.fit.model) &&
      std::abs(now.score - before.score) < kAsBefore)
    now = before;
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
    out.alternatives.push_back(!thorough                      ? std::vector<Rival>{}
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
