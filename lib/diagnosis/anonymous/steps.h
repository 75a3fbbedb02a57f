// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Moments at which the pair becomes another one and stays so: a gain that is switched, a contact, a
// magnet that slips, an offset that jumps. A step is what a few smooth functions of time cannot
// follow, and what wanders does not do.
#pragma once

#include <optional>
#include <vector>

#include "diagnosis/anonymous/basis.h"
#include "diagnosis/search/fit.h"

namespace ada {

/// Between which times a step lies.
struct StepPlace {
  double from_s, to_s;
};

/// Places at which offsets, gain and angle, or mismatch and quadrature of a residual jump by eight
/// times what they do from one stretch to the next elsewhere; the largest come first. None where
/// the speed changes at once: that would be what the speed does. Nothing where the samples hold too
/// few stretches to know what is usual.
std::optional<std::vector<StepPlace>> find_steps(const Basis &basis, const Observations &data,
                                                 const ResidualColumns &rest,
                                                 double electrical_periods);

/// The moment of a step, s: between the two samples at which a pair of its own on either side
/// leaves least of the residual.
double moment_of_step(const Basis &basis, const Observations &near, const ResidualColumns &rest);

} // namespace ada
