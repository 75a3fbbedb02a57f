// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The search for causes: forward by the candidate that held-out data confirm best, backward by
// what they can do without, sideways by rivals. Nothing here knows an effect by name.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/anonymous/discrepancy.h"
#include "diagnosis/conditions/observations.h"
#include "diagnosis/search/candidates.h"
#include "diagnosis/search/fit.h"

namespace ada {

/// Data that the search works on. Two captures may stand behind it: one trains, one judges.
struct SearchData {
  const Scene *scene; ///< of the training data
  Observations train, heldout;
  const Scene *judge; ///< of the held-out data; the same scene unless a second capture judges
};

/// A cause that the data do not tell from one that was found, and the model with it instead.
struct Rival {
  std::string id;
  Model model;
};

struct SearchResult {
  FitResult fit;
  std::vector<std::size_t> order; ///< indices of the found effects in the order of their gain
  std::vector<double> contribution;
  std::vector<std::vector<Rival>> alternatives;
  double residual_rms_v = 0.0;           ///< of the training part
  double supply_rms_fraction = 0.0;      ///< of a supply variation seen without a VDD channel
  Direction disturbed = Direction::none; ///< and how residuals were weighed in the end
  double weight_along = 1.0;
  std::size_t by_direction = 0; ///< the last so many of `order` are told by the direction alone

  /// Takes the finding at this place of `order` out of everything.
  void forget(std::size_t place);
  /// Names it after all others.
  void name_last(std::size_t place);
};

/// Mean squares of what no physical cause accounts for, V^2 of a channel.
struct Unnamed {
  double angle_v2 = 0.0;     ///< of it, what repeats with the angle
  double elsewhere_v2 = 0.0; ///< and what does not: that of the other axes, and what is on none
};

using Report = std::function<void(double, const char *)>;

class Search {
public:
  Search(SearchData data, Model baseline, double noise_v, Report report);

  /// Not `thorough`: only what is found on the way up, without rivals and second thoughts; that
  /// tells what bends the motion, in a part of the time. `found`: physical causes known already, to
  /// which signatures may come; without it only physical causes are looked for. `unnamed`: beside
  /// those that were found. `seen`: causes that a look at the data told, with which it begins, and
  /// which have to hold like any other.
  SearchResult run(bool thorough, const Model *found = nullptr, const Unnamed &unnamed = {},
                   const std::vector<EffectInstance> &seen = {});

  /// Once more from what was found, with what nobody can name as a part of the noise.
  SearchResult run_against(const Discrepancy &discrepancy, const Unnamed &unnamed,
                           const Model &found);

  /// The causes of a model that others cancel, and that leave more than noise all the same, the
  /// least likely before any data first; `now`: as it was fitted last.
  std::vector<std::size_t> cancelled(const Model &now);

private:
  struct State {
    FitResult fit;
    Model judged;   ///< as the held-out data see it: a second capture has its own zero angle
    double score;   ///< log likelihood of the held-out data under the training fit
    double heldout; ///< whitened sum of squares of the held-out data
  };

  /// What a fit begins with, to the bit: baseline, effects, numbers, and iterations.
  using Start = std::vector<std::uint64_t>;
  static Start start_of(const Model &model, int iterations);
  /// What may be beside a model, what this capture cannot show as such included, best first.
  const std::vector<Candidate> &candidates_beside(const Model &model, bool signatures) const;
  /// After a change of the weights.
  void forget() const;
  State fitted(const Model &start, int iterations) const;

  SearchResult result(State &now, bool thorough);
  void colour(const Discrepancy &discrepancy);
  bool refuted(const State &state, std::size_t effect) const;
  bool refuted(const State &state, std::size_t from, std::size_t to,
               bool told_from_speed = true) const;
  bool dominates(double size_v, std::size_t effect, const Model &model) const;
  bool worth_keeping(double worth, const Effect &effect) const;
  double against_unnamed(const State &with, const State &less, std::size_t effect) const;
  bool helps_everywhere(const State &with, const State &less) const;
  bool helps_both_channels(const State &with, const State &less, std::size_t effect) const;
  bool helps_in_each_direction(const State &with, const State &less) const;
  double unknown_v(const State &now) const;
  double moved_off_angle_v(const Model &model, std::size_t effect) const;
  bool stands_out(const State &now, std::size_t effect, double size_v) const;
  bool leaves_noise(const State &now) const;
  bool is_shape_of_event(const Model &model, std::size_t effect) const;
  bool may_not_be_of_time(const State &state, std::size_t effect) const;
  void measure_discrepancy();
  Eigen::MatrixXd own_moves(const Model &model) const;
  bool stands_alone(const Eigen::MatrixXd &own, std::size_t effect) const;
  bool the_records_could(const State &state, std::size_t effect) const;
  bool adds_up(const FitResult &fit, std::size_t effect) const;
  bool others_stay(const Model &model, std::size_t effect, const Model &rival, double part) const;
  bool all_stand_alone(const Model &model) const;
  State evaluate(const Model &start, int iterations = 6) const;
  double log_likelihood(const FitResult &fit, double heldout) const;
  void progress(const char *what);
  double doubt_v(const Model &model) const;
  bool beyond_doubt(double size_v, const Model &model, std::size_t effect, double doubt) const;
  bool forward(State &now);
  bool forward_together(State &now);
  void climb(State &now);
  void choose(State &now, std::size_t effect) const;
  std::vector<std::size_t> suspects(const State &now) const;
  double value(const State &state) const;
  bool choose_simpler(State &now);
  bool shared_with_signature(const Model &model) const;
  bool needs_less(const State &fewer, const State &now) const;
  bool exchange(State &now);
  bool backward(State &now);
  bool exchange_rivals(State &now);
  bool blame_reference(State &now) const;
  struct AlongSupply {
    double along = 0.0, across = 0.0, length2 = 0.0; ///< V^2, means of a sample
    double fixed = 0.0;                              ///< across the best fixed direction instead
    double repeats = 0.0;   ///< part of `along` that repeats with the angle
    double length_v2 = 0.0; ///< along the vector from the centre, of which a supply moves
    double of_length = 0.0; ///< this part
    bool is_supply() const;
  };
  AlongSupply along_supply(const State &now) const;
  AlongSupply weigh_supply(State &now, double share);
  bool notice_supply(State &now);
  bool doubt_supply(State &now);
  bool notice_supply_in_radius(State &now);
  void weigh_motion(State &now);
  double part_of_reference(const Model &model) const;
  void weigh_anew(State &now);
  void settle_supply(State &now);
  void weigh(State &now, Direction direction, double weight);
  State without(const State &now, std::size_t effect) const;
  std::vector<Rival> rivals(const State &now, std::size_t effect, State *better) const;
  double contribution(const State &with, const State &less) const;
  double volts_explained(const State &with, const State &less) const;
  double size_of(const State &with, const State &less, std::size_t effect) const;

  SearchData data_;
  Observations quick_;  ///< a thinned part of the training data, for looking around
  Observations coarse_; ///< a thinner one, for first fits
  Model baseline_;
  std::size_t given_; ///< effects that the baseline brought along
  double noise_v_;
  double discrepancy_v_ = 0.0; ///< what the baseline leaves over, V rms of a channel
  Report report_;
  double supply_rms_fraction_ = 0.0;
  Unnamed unnamed_;        ///< beside what was found
  bool signatures_ = true; ///< whether shapes without a physical cause are tried
  bool supply_rejected_ = false, exchanged_ = false, begun_anew_ = false;
  /// Effects of the model in which no supply was seen last; one more may bring it out.
  std::size_t looked_at_with_ = static_cast<std::size_t>(-1);
  int steps_ = 0;
  /// Alternatives found so far, by the score of the state and the effect: what is compared on the
  /// way is asked for again at the end.
  std::map<std::pair<double, std::size_t>, std::vector<Rival>> known_rivals_;
  /// Fits made so far to the data as they are weighed now, and the ways to go on from them:
  /// forward, backward and sideways ask for many of them again.
  mutable std::vector<std::uint32_t>
      by_place_; ///< the training samples, by their place in the turn
  mutable std::map<Start, State> known_fits_;
  mutable std::map<std::pair<Start, bool>, std::vector<Candidate>> known_candidates_;
};

} // namespace ada
