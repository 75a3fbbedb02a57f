// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a model does not know about itself: how large its own second-order terms are, and which of
// its parts the data cannot tell apart.
#pragma once

#include <numeric>
#include <vector>

#include "diagnosis/conditions/observations.h"
#include "diagnosis/search/fit.h"

namespace ada {

/// Whether an effect is a function of the angle alone, so that stages blur its higher terms.
bool is_static(const Effect &effect);

/// Sizes of the offsets and of every effect that acts at rest, V rms of the pair.
struct Sizes {
  std::vector<double> each;
  /// Whether what it does to the pair is a linear map and a shift, of two of which the product is
  /// one, too: an ellipse stays an ellipse, in whatever order.
  std::vector<bool> affine;
  double own_squares = 0.0; ///< of those that may be the leading term of something else
  double sum() const { return std::accumulate(each.begin(), each.end(), 0.0); }
};
Sizes sizes_at_rest(const Scene &scene, const Observations &data, const Model &model);

/// What products of the effects so far may leave over, V rms: the order in which two stages really
/// act is not known to second order, so nothing of that size is evidence of a further cause. These
/// are effects that act at rest, and so their products repeat with the angle.
double second_order(const Scene &scene, const Observations &data, const Model &model);

/// What the next term of the series by which a filter sees a recorded supply would be, V rms.
double next_of_supply(const Observations &data, const Model &model);

/// Whether a transfer error acts on the pair with its offsets or before they are added is not known
/// either: the difference between the two, V rms of a channel.
double offsets_in_transfer(const Observations &data, const Model &model);

/// How much of what a cause explains a rival of the same leading shape may leave over: two
/// functions of the angle alone differ in their higher terms, which the order of the stages blurs.
class Blur {
public:
  /// The cause at this place of a model, and what the others do.
  Blur(const Scene &scene, const Observations &data, const Model &model, std::size_t effect);
  /// V rms of a channel, of the `part` that the cause explains; 0 where one of the two is no such
  /// function.
  double left_by(const EffectInstance &rival, double part) const;

private:
  bool repeats_;
  double amplitude_v_, offset_v_, in_transfer_v_, others_v_;
};

/// How many of its standard errors an effect is away from none, over its coordinates in the mean
/// (Wald).
double errors_from_none(const FitResult &fit, std::size_t effect);

/// Largest correlation of any mixture of one effect's coordinates with any of another's from
/// `first` on, 0 to 1: at 1 the two are one in these data. Of a cause that shows with the angle
/// alone and one that shows beyond it no correlation counts.
double canonical_correlation(const FitResult &fit, std::size_t effect, std::size_t first);

} // namespace ada
