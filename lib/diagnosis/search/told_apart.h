// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Causes that may be there beside those that were found, and what these then are.
#pragma once

#include <vector>

#include "diagnosis/search/fit.h"
#include "diagnosis/search/search.h"
#include "motion/reference_rows.h"

namespace ada {

/// A cause on which the value of one that was found hangs.
struct Untold {
  std::size_t effect; ///< of the model
  const Effect *other;
};

/// Adds to the covariance how far what every pair has moves if a cause that is as likely before any
/// data is there beside it, one that shows beyond the angle or a field error on an arc: the
/// variance between models of Hoeting and others 1999. Where nothing is known of the two but their
/// sum, as at one speed, one of them has the name and the other is its alternative.
std::vector<Untold> widen_by_what_is_not_told_apart(const Observations &data, FitResult &result);

/// The same for the choices of an effect, such as where a transfer is straight: where another does
/// nearly as well, every number hangs on it.
void widen_by_choices(const Observations &data, FitResult &result);

/// The same for what else a cause of the model may be. Held-out data reject none of its rivals, so
/// each is as likely as the cause itself, and every other number is that beside the one or the
/// other. `as_found`: the model as these data alone have it, to be compared with.
void widen_by_rivals(const Observations &data, const Model &as_found, std::size_t effect,
                     const std::vector<Rival> &rivals, FitResult &result);

/// The same for causes that turn the vector, of the sensor or of the reference, beside what the
/// reference ripples by against even time at their order, entry n - 1 order n. Where that is not
/// what the model says of the reference, both may err there, or the shaft may ripple: the cause is
/// what it is or what that leaves of it.
std::vector<Untold> widen_by_ripples(const std::vector<Ripple> &ripples, const Observations &data,
                                     const SearchResult &found, FitResult &result);

} // namespace ada
