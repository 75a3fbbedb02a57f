// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Whether a residual is white along angle, time, temperature, speed and frequency.
#pragma once

#include <vector>

#include "diagnosis/conditions/observations.h"
#include "diagnosis/search/fit.h"
#include "diagnosis/words/result.h"

namespace ada {

/// Structure that stands clear of white noise: significant, and larger than `least_rms_v`, below
/// which nothing is worth a word. `residual`: of `model`; `sigma_v`: white noise of one channel.
std::vector<Structure> find_structure(const Scene &scene, const Observations &data,
                                      const ResidualColumns &residual, const Model &model,
                                      double sigma_v, double least_rms_v, int orders);

/// What shows where the motion is not known well enough for the whole pair: the radius of stretches
/// that were left out. `floor_v`: rms of a channel that noise and what is not modelled may leave.
std::vector<Structure> find_structure_in_rough(const Scene &scene, const Model &model,
                                               double floor_v);

/// Samples in a row that passed for spikes and that the model does not meet either.
std::vector<Structure> find_bursts(const Scene &scene, const Model &model, double floor_v);

/// An angle that moves from sample to sample by more than the radius does: no noise of the pair,
/// and no shaft turns so. `data` at the angle of the smooth motion.
std::vector<Structure> find_jitter(const Observations &data, const ResidualColumns &residual);

} // namespace ada
