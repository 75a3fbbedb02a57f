// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A cause that goes as slowly as a process, as an offset that follows the temperature does beside
// one that wanders, is told from it by no more than the half waves that the process has.
#pragma once

#include <vector>

#include "diagnosis/conditions/observations.h"
#include "diagnosis/noise/random_causes.h"
#include "model/model.h"

namespace ada {

/// What a process adds to the standard errors of one cause of `model`, by parameter, in its units.
/// `waves`: half waves that it goes on with over the record. It is taken for a walk, the slowest
/// waves of which are the largest.
std::vector<double> errors_beside(const Observations &data, const Model &model, std::size_t effect,
                                  const RandomCause &process, int waves);

/// By how much the log likelihood of what is left is larger with a cause than without it, where
/// what is left is a walk of this pattern and of any size, with noise on it: a slow shape takes a
/// half wave or two of a walk, and has half a nat by chance for each channel.
double nats_over_walk(const Observations &data, const Model &with, const Model &less,
                      Pattern pattern);

/// By how much the mean square of a walk is larger than what is left of it where so many slow
/// shapes were fitted beside it: those may have taken its slowest half waves.
double more_of_walk(int taken);

} // namespace ada
