// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the numbers of a model owe to a cause that nothing bears out.
#pragma once

#include "diagnosis/search/fit.h"

namespace ada {

/// A cause of m numbers that is named by m numbers of the data takes a part of its shape from the
/// other causes without any evidence of its own: with one period a turn a sensor beside its axis is
/// the image of mismatch and quadrature error together with a third harmonic, and of that third
/// harmonic alone nobody knows that it is not there by itself. Of the two readings, the cause, and
/// what it alone explains left without a name, either may be true: the errors of the other numbers
/// hold both (the variance between models of Hoeting et al., Bayesian model averaging, Statistical
/// Science 14, 1999, of two that are as likely). What a cause explains beyond its own numbers, as a
/// field from outside does with two periods a turn, bears it out.
void widen_by_what_is_not_borne_out(const Observations &data, FitResult &result);

} // namespace ada
