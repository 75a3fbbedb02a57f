// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/by_chance.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "diagnosis/admission.h"
#include "diagnosis/along_and_across.h"
#include "diagnosis/beside_anonymous.h"
#include "diagnosis/criteria.h"
#include "diagnosis/first_model.h"
#include "diagnosis/fit.h"
#include "diagnosis/repetition.h"

namespace ada {

namespace {

/// Mean square without a name, V^2, of a kind that a cause could be the nearest shape of: on its
/// own axis, and half of what lies on those along which the shaft goes as fast as it turns. Of a
/// structure that had more of its power on the cause's axis than there, more would be left here.
/// What goes on in time is another thing in each turn, of which a function of the angle takes a
/// part that falls with their number; what repeats with the angle is the same at the same place,
/// where a cause beyond the angle is not.
double could_be_v2(const Anonymous &left, const Effect &cause, double in_time_v2, double rounds) {
  double sum = of_the_angle(cause) ? in_time_v2 / std::max(1.0, rounds) : 0.0;
  for (std::size_t k = 0; k < kAxes; ++k) {
    const auto axis = static_cast<Axis>(k);
    const bool own = axis_name(axis) == cause.info().axis;
    if (own || axis == Axis::speed || axis == Axis::frequency)
      sum += (own ? 1.0 : criteria::kOfOtherAxes) * std::max(0.0, left.selection.share_v2[k]);
  }
  return sum;
}

/// Mean square, V^2 of a channel, that goes on in time in held-out data: slowly, or from row to row
/// beside all that has an axis.
double in_time_v2(const Anonymous &left, const Parts &parts, const Model &model) {
  ResidualColumns rest = residual_columns(parts.heldout, as_seen_by(parts.heldout, model));
  subtract(left.basis, left.selection, parts.heldout, rest);
  return std::max(0.0, left.selection.share_v2[static_cast<std::size_t>(Axis::time)]) +
         std::pow(goes_on_v(rest), 2);
}

/// Mean square across the vector that a model leaves of held-out data, V^2.
double across_v2(const Parts &parts, const Model &model) {
  std::vector<double> along, across;
  split(parts.heldout, residual_columns(parts.heldout, as_seen_by(parts.heldout, model)), along,
        across);
  return mean_square(across);
}

} // namespace

void drop_what_chance_would_take(const Scene &scene, Parts parts, SearchResult &found) {
  parts.weigh(found.disturbed, found.weight_along);
  parts.train = thinned(parts.train);
  parts.train.coloured.reset();
  for (;;) {
    const Model model = fit(parts.train, with_expected(found.fit.model), kRefit).model;
    const Anonymous left = anonymous_of(scene, parts, model);
    const double with_v2 = left_v2(parts, model), slow_v2 = in_time_v2(left, parts, model);
    std::size_t least_place = found.order.size();
    double least = criteria::kOfRival;
    for (std::size_t place = 0; place < found.order.size(); ++place) {
      const std::size_t at = found.order[place];
      const EffectInfo &info = model.effects[at].effect->info();
      if (info.prior_rank == 0 || info.evidence != Evidence::signal ||
          info.spoils != Spoils::nothing)
        continue;
      const double unnamed_v2 =
          could_be_v2(left, *model.effects[at].effect, slow_v2, scene.rounds(1.0));
      if (unnamed_v2 <= std::pow(criteria::kOfUnknown, 2) * left.selection.noise_v2)
        continue;
      const Model less = fit(parts.train, model.without(at), kRefit).model;
      const double takes_v2 = std::max(0.0, left_v2(parts, less) - with_v2),
                   part = takes_v2 / (takes_v2 + unnamed_v2);
      if (part < least && (!parts.has_reference ||
                           across_v2(parts, model) > criteria::kOfRival * across_v2(parts, less))) {
        least = part;
        least_place = place;
      }
    }
    if (least_place == found.order.size())
      return;
    found.forget(least_place);
    found.fit.model = fit(parts.train, found.fit.model, kRefit).model;
  }
}

} // namespace ada
