// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What else it may be: causes in the place of one that was found.

#include <algorithm>
#include <cmath>

#include "diagnosis/criteria.h"
#include "diagnosis/events/change_points.h"
#include "diagnosis/search/admission.h"
#include "diagnosis/search/candidates.h"
#include "diagnosis/search/identifiability.h"

namespace ada {

/// Choices that no search for a place decides, such as where a transfer is straight, are tried both
/// ways.
void Search::choose(State &now, std::size_t effect) const {
  const EffectInstance e = now.fit.model.effects[effect];
  for (auto &values : e.effect->choices(e.values)) {
    Model model = now.fit.model;
    model.effects[effect].values = std::move(values);
    State other = evaluate(model);
    if (other.fit.determined && other.score > now.score + criteria::kNatsPerCoordinate)
      now = std::move(other);
  }
}

/// A rival takes the place of one cause and leaves the others what they are: one of them that grows
/// by more than that cause explained, and twice as much, does its work.
bool Search::others_stay(const Model &model, std::size_t effect, const Model &rival,
                         double part) const {
  for (std::size_t k = given_, r = given_; k < model.effects.size(); ++k)
    if (k != effect && moved_rms_v(quick_, rival, r++) > moved_rms_v(quick_, model, k) + 2.0 * part)
      return false;
  return true;
}

namespace {

/// Whether an effect says of itself that it looks like another.
bool knows(const Effect &self, const Effect &other) {
  return std::ranges::any_of(self.info().separations,
                             [&](const Separation &s) { return s.rival == other.info().id; });
}

/// Whether a cause that the capture cannot show as such may yet be what was found: one that effects
/// know to look alike. Beside a reference that follows the shaft no motion does.
bool may_look_alike(const Effect &found, const Effect &invisible, bool has_reference) {
  if (!has_reference)
    return true;
  return invisible.info().stage != Stage::motion &&
         (knows(found, invisible) || knows(invisible, found));
}

} // namespace

std::vector<Rival> Search::rivals(const State &now, std::size_t effect, State *better) const {
  std::vector<Rival> out;
  const State less = without(now, effect);
  const Effect *self = now.fit.model.effects[effect].effect;
  const double part = contribution(now, less);
  const double n = static_cast<double>(data_.heldout.size());
  std::vector<Candidate> list = candidates_beside(less.fit.model, signatures_);
  std::erase_if(list, [&](const Candidate &c) {
    return !c.visible && !may_look_alike(*self, *c.effect, data_.scene->has_reference);
  });
  const double my_side = side_evidence(data_, now.fit.model);
  // What higher terms can leave over is no reason to reject a rival of the same leading shape.
  const Blur blur(*data_.scene, quick_, now.fit.model, effect);
  const double noise = std::max(noise_v_, data_.scene->white_noise_v);
  double highest = 0.0;
  for (const Candidate &c : list)
    if (c.effect == self)
      highest = c.gain;
  if (highest == 0.0 && !list.empty())
    highest = list.front().gain;
  // A law of the speed says of a step what a step says of it: where the speed changed but once, and
  // then, the data do not tell them apart.
  const bool told_from_speed = self->info().axis != axis_name(Axis::speed);
  for (const Candidate &c : list) {
    // To first order, and beside what has no name, one of two that look alike may seem far less: it
    // is an alternative then.
    const bool comparable = c.gain >= criteria::kComparable * highest;
    if (c.effect == self || (!comparable && !knows(*self, *c.effect)))
      continue;
    // A signature takes the place of no physical cause, unless other evidence speaks for it, and is
    // told of beside one that says of itself that it looks so; without a reference nothing tells
    // them apart.
    const bool a_cause = !c.effect->info().signature || self->info().signature ||
                         side_evidence(data_, c.start) > my_side + criteria::kRivalNats;
    if (!a_cause && data_.scene->has_reference && !knows(*self, *c.effect))
      continue;
    State rival = evaluate(with_exact_moments(*data_.scene, c.start, c.start.effects.size() - 1));
    choose(rival, rival.fit.model.effects.size() - 1);
    if (!rival.fit.determined || !in_range(rival.fit.model, given_) ||
        !all_stand_alone(rival.fit.model) ||
        refuted(rival, rival.fit.model.effects.size() - 1, rival.fit.model.effects.size(),
                told_from_speed))
      continue;
    const double side = side_evidence(data_, rival.fit.model) - my_side;
    const double blurred = blur.left_by(c.start.effects.back(), part);
    const double left = std::sqrt(std::max(0.0, rival.heldout - now.heldout) / (2.0 * n));
    if (side < -criteria::kRivalNats ||
        (rival.score - side < now.score - criteria::kRivalNats && left > blurred))
      continue;
    if (others_stay(now.fit.model, effect, rival.fit.model, part))
      out.push_back({std::string(c.effect->info().id), rival.fit.model});
    // A signature may be a patch on the wrong one of two causes: with the right one it has nothing
    // to do.
    for (std::size_t j = given_; better && c.visible && a_cause && !c.effect->info().signature &&
                                 j + 1 < rival.fit.model.effects.size();
         ++j)
      if (rival.fit.model.effects[j].effect->info().signature)
        if (State fewer = without(rival, j);
            fewer.fit.determined && value(fewer) > value(now) &&
            (better->score == 0.0 || value(fewer) > value(*better)))
          *better = std::move(fewer);
    const double saved =
        penalty(now.fit.model.effects[effect]) - penalty(rival.fit.model.effects.back());
    const bool yields = self->info().yields_to == c.effect->info().id;
    const double needed = yields ? -criteria::kRivalNats : criteria::kRivalNats;
    // More numbers are no better cause, unless other evidence pays for them.
    if (better && comparable && c.visible && (saved >= 0.0 || side > criteria::kRivalNats) &&
        (rival.score + saved > now.score + needed ||
         // What the order of the stages blurs speaks for neither: other evidence does.
         (side > criteria::kRivalNats && left <= blurred) ||
         c.effect->info().prior_rank < self->info().prior_rank ||
         (yields &&
          left <= std::min({blurred, criteria::kSlight * part, criteria::kHidden * noise}))) &&
        a_cause && (better->score == 0.0 || rival.score > better->score))
      *better = std::move(rival);
  }
  return out;
}

/// The reference is one body: where it wobbles at one order, and has lines at another, they are
/// read at the same place, and blamed on the sensor one by one each makes the other fit worse. So
/// all that an error of the reference may be in the place of, and that its ripple against time
/// speaks for, change sides at once.
bool Search::blame_reference(State &now) const {
  if (data_.scene->reference_ripples.empty())
    return false;
  Model model = now.fit.model;
  std::size_t moved = 0;
  for (std::size_t k = given_; k < now.fit.model.effects.size(); ++k) {
    if (!of_the_angle(*now.fit.model.effects[k].effect))
      continue;
    const State less = without(now, k);
    const std::vector<Candidate> &list = candidates_beside(less.fit.model, true);
    const double side = side_evidence(data_, less.fit.model);
    double highest = 0.0;
    for (const Candidate &c : list)
      highest = std::max(highest, c.gain);
    for (const Candidate &c : list) {
      const EffectInstance &e = c.start.effects.back();
      if (c.gain < criteria::kComparable * highest ||
          !(e.effect->reference_ripple(e.values).order > 0.0) ||
          side_evidence(data_, c.start) <= side)
        continue;
      model.effects[k] = e;
      ++moved;
      break;
    }
  }
  if (moved < 2)
    return false;
  State other = evaluate(model, 12);
  if (!other.fit.determined || !in_range(other.fit.model, given_) ||
      value(other) < value(now) + criteria::kRivalNats)
    return false;
  now = std::move(other);
  return true;
}

bool Search::exchange_rivals(State &now) {
  for (std::size_t k = given_; k < now.fit.model.effects.size(); ++k) {
    State better{};
    known_rivals_[{now.score, k}] = rivals(now, k, &better);
    if (better.score != 0.0) {
      now = std::move(better);
      return true;
    }
  }
  return blame_reference(now);
}

} // namespace ada
