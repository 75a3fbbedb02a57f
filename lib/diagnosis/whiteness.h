// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Whether a residual is white along angle, time, temperature, speed and frequency.
#pragma once

#include <vector>

#include "diagnosis/fit.h"
#include "diagnosis/observations.h"
#include "diagnosis/result.h"

namespace ada {

/// Structure that stands clear of white noise: significant, and larger than `least_rms_v`, below
/// which nothing is worth a word. `sigma_v`: white noise of one channel.
std::vector<Structure> find_structure(const Scene &scene, const Observations &data,
                                      const ResidualColumns &residual, double sigma_v,
                                      double least_rms_v);

} // namespace ada
