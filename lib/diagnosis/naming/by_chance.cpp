// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/naming/by_chance.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <optional>
#include <vector>

#include "base/angle.h"
#include "diagnosis/anonymous/beside_anonymous.h"
#include "diagnosis/criteria.h"
#include "diagnosis/naming/own_orders.h"
#include "diagnosis/noise/along_and_across.h"
#include "diagnosis/residual/repetition.h"
#include "diagnosis/search/admission.h"
#include "diagnosis/search/first_model.h"
#include "diagnosis/search/fit.h"

namespace ada {

namespace {

/// Mean square without a name, V^2, of a kind that a cause could be the nearest shape of: on its
/// own axis, and half of what lies on those along which the shaft goes as fast as it turns. Of a
/// structure that had more of its power on the cause's axis than there, more would be left here.
/// What goes on in time is another thing in each turn, of which a function of the angle or of the
/// speed takes a part that falls with their number; what repeats with the angle is the same at the
/// same place, where a cause beyond the angle is not.
double could_be_v2(const Anonymous &left, const Effect &cause, double in_time_v2, double rounds) {
  const bool of_motion = of_the_angle(cause) || cause.info().axis == axis_name(Axis::speed);
  double sum = of_motion ? in_time_v2 / std::max(1.0, rounds) : 0.0;
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
double in_time_v2(const Anonymous &left, const DataSplit &split, const Model &model) {
  ResidualColumns rest = residual_columns(split.heldout, as_seen_by(split.heldout, model));
  subtract(left.basis, left.selection, split.heldout, rest);
  return std::max(0.0, left.selection.share_v2[static_cast<std::size_t>(Axis::time)]) +
         std::pow(goes_on_v(rest), 2);
}

/// Mean square along the vector and across it that a model leaves of held-out data, V^2.
struct LeftOver {
  double along_v2, across_v2;
};
LeftOver left_over(const DataSplit &split, const Model &model) {
  std::vector<double> along, across;
  along_and_across(split.heldout, residual_columns(split.heldout, as_seen_by(split.heldout, model)),
                   along, across);
  return {mean_square(along), mean_square(across)};
}

/// Whether a cause takes more than half of what is left above the noise in one direction, beside a
/// reference: no shape does by chance.
bool takes_most_of_one_direction(const DataSplit &split, const Model &with, const Model &without,
                                 double noise_v2) {
  const LeftOver less = left_over(split, with), all = left_over(split, without);
  const auto most = [&](double left_v2, double left_without_v2) {
    return left_without_v2 > noise_v2 &&
           left_without_v2 - left_v2 > std::pow(criteria::kOfUnknown, 2) * noise_v2 &&
           left_v2 - noise_v2 <= criteria::kOfRival * (left_without_v2 - noise_v2);
  };
  return most(less.along_v2, all.along_v2) || most(less.across_v2, all.across_v2);
}

/// Amplitudes of the half waves over the record, from none on, of what is seen in order: their
/// squares add to the mean square of its means over as many parts.
std::vector<double> half_waves(const std::vector<double> &x) {
  constexpr std::size_t kMost = 128, kRows = 8; // half waves, and rows that each of them is told by
  const std::size_t n = std::min(kMost, x.size() / kRows);
  std::vector<double> out(n);
  for (std::size_t bin = 0; bin < n; ++bin) {
    const std::size_t from = bin * x.size() / n, to = (bin + 1) * x.size() / n;
    const double mean = std::accumulate(x.begin() + static_cast<std::ptrdiff_t>(from),
                                        x.begin() + static_cast<std::ptrdiff_t>(to), 0.0) /
                        static_cast<double>(to - from);
    for (std::size_t k = 0; k < n; ++k)
      out[k] += (k == 0 ? 1.0 : std::numbers::sqrt2) * mean / static_cast<double>(n) *
                std::cos(0.5 * kTwoPi * static_cast<double>(k) * (static_cast<double>(bin) + 0.5) /
                         static_cast<double>(n));
  }
  return out;
}

/// Mean square that a walk which leaves `rest` would have, by chance, of the course in time that
/// `shape` has: of a walk the power of the k-th half wave falls with its square, so that those
/// which are left tell what those had that the shape took.
double walked_v2(const std::vector<double> &shape, const std::vector<double> &rest) {
  const std::vector<double> of = half_waves(shape), left = half_waves(rest);
  const std::size_t n = left.size();
  constexpr std::size_t kFirst = 3; // the slowest go with what was fitted
  if (n < 8 * kFirst)
    return 0.0;
  double white = 0.0, walk = 0.0, whole = 0.0, course = 0.0, squares = 0.0;
  for (std::size_t k = n / 2; k < n; ++k)
    white += left[k] * left[k] / static_cast<double>(n - n / 2);
  for (std::size_t k = kFirst; k < n / 4; ++k) {
    walk += left[k] * left[k] - white;
    whole += 1.0 / static_cast<double>(k * k);
  }
  for (std::size_t k = 1; k < n; ++k) {
    course += of[k] * of[k] / static_cast<double>(k * k);
    squares += of[k] * of[k];
  }
  return squares > 0.0 ? std::max(0.0, walk) / whole * course / squares : 0.0;
}

/// The same of what a model without one cause leaves, in V^2 of a channel, beside all that has an
/// axis: a zero that creeps walks across the vector, an offset that drifts in a channel.
double walked_v2(const Observations &some, const Anonymous &left, const Model &with,
                 const Model &without) {
  ResidualColumns rest = residual_columns(some, with), shape = residual_columns(some, without);
  for (std::size_t i = 0; i < some.size(); ++i) {
    shape.sin[i] -= rest.sin[i];
    shape.cos[i] -= rest.cos[i];
  }
  subtract(left.basis, left.selection, some, rest);
  std::vector<double> along, across, shape_along, shape_across;
  along_and_across(some, rest, along, across);
  along_and_across(some, shape, shape_along, shape_across);
  return 0.5 * std::max(walked_v2(shape_along, along) + walked_v2(shape_across, across),
                        walked_v2(shape.sin, rest.sin) + walked_v2(shape.cos, rest.cos));
}

} // namespace

void drop_what_chance_would_take(const Scene &scene, DataSplit split, SearchResult &found) {
  constexpr std::size_t kEnough = 4000;
  constexpr double kSigmas = 3.0; // by which each cause differs from none
  split.weigh(found.disturbed, found.weight_along);
  split.train = thinned(split.train);
  split.train.coloured.reset();
  std::vector<std::uint32_t> indices(scene.all.size());
  std::iota(indices.begin(), indices.end(), 0u);
  const Observations some = scene.all.select(thin(indices, kEnough, 100));
  for (;;) {
    const Model model = fit(split.train, with_expected(found.fit.model), kRefit).model;
    const Anonymous left = anonymous_of(scene, split, model);
    const double with_v2 = left_v2(split, model), slow_v2 = in_time_v2(left, split, model);
    const double share_of_angle_v2 =
        std::max(0.0, left.selection.share_v2[static_cast<std::size_t>(Axis::angle)]);
    std::optional<OwnOrders> orders;
    std::size_t least_place = found.order.size();
    double least = criteria::kOfRival;
    for (std::size_t place = 0; place < found.order.size(); ++place) {
      const std::size_t at = found.order[place];
      const EffectInfo &info = model.effects[at].effect->info();
      if (info.prior_rank == 0 || info.evidence != Evidence::signal ||
          info.spoils != Spoils::nothing || is_measured_aside(split.train, model, at))
        continue; // another channel says it
      const double unnamed_v2 =
          could_be_v2(left, *model.effects[at].effect, slow_v2, scene.rounds(1.0));
      if (std::max(unnamed_v2, slow_v2) <=
          std::pow(criteria::kOfUnknown, 2) * left.selection.noise_v2)
        continue;
      const Model less = fit(split.train, model.without(at), kRefit).model;
      const double takes_v2 = std::max(0.0, left_v2(split, less) - with_v2),
                   part = takes_v2 / (takes_v2 + unnamed_v2);
      const double walk_v2 = kSigmas * kSigmas * walked_v2(some, left, model, less),
                   of_walk = takes_v2 / (takes_v2 + walk_v2);
      if (of_walk < least && info.character != Character::event &&
          with_v2 > criteria::kNextToNothing * (with_v2 + takes_v2)) {
        least = of_walk;
        least_place = place;
      }
      if (part >= least)
        continue;
      // Structure at other orders than the cause's is none that it could be a part of. Without a
      // reference what turns the vector is the motion's.
      double nearer_v2 = unnamed_v2;
      if (split.has_reference) {
        AtOwnOrders own;
        if (info.axis == axis_name(Axis::angle)) {
          if (!orders)
            orders.emplace(left, some);
          own = orders->of(model, less);
          nearer_v2 -= std::max(0.0, share_of_angle_v2 - own.by_chance_v2 - own.left_along_v2);
        }
        if (own.left_along_v2 <= criteria::kOfRival * takes_v2 &&
            takes_most_of_one_direction(split, model, less, left.selection.noise_v2))
          continue;
      }
      if (const double nearer = takes_v2 > 0.0 ? takes_v2 / (takes_v2 + nearer_v2) : 0.0;
          nearer < least) {
        least = nearer;
        least_place = place;
      }
    }
    if (least_place == found.order.size())
      return;
    found.forget(least_place);
    found.fit.model = fit(split.train, found.fit.model, kRefit).model;
  }
}

} // namespace ada
