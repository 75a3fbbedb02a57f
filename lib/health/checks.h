// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The checks, in the order in which they are printed. Each looks at the evidence and at nothing
// else.
#pragma once

#include <string>
#include <vector>

#include "health/evidence.h"
#include "health/health.h"
#include "health/wrong_stretches.h"

namespace ada::health {

// signal.cpp: the voltages
HealthCheck check_range(const Evidence &e);
HealthCheck check_radius(const Evidence &e);
HealthCheck check_rails(const Evidence &e);
HealthCheck check_amplitude(const Evidence &e);
HealthCheck check_supply(const Evidence &e);

// temperature.cpp: VTEMP; only of a capture that has it
HealthCheck check_vtemp(const Evidence &e);

// channels.cpp: the two of them together
HealthCheck check_rotation(const Evidence &e);
HealthCheck check_clipping(const Evidence &e);
HealthCheck check_stuck(const Evidence &e);
HealthCheck check_short(const Evidence &e);

// record.cpp: sample by sample
HealthCheck check_spikes(const Evidence &e);
HealthCheck check_numbers(const Evidence &e);
HealthCheck check_noise(const Evidence &e);

// times.cpp: the time column
HealthCheck check_gaps(const Evidence &e);

// reference.cpp: the two angles; only of a capture that has a reference
HealthCheck check_reference(const Evidence &e);

// checks.cpp: what they share
/// The reason is told by check_rotation.
inline constexpr const char *kNoCircle = "there is no circle to measure it on";
HealthCheck verdict(std::string id, bool passed, double measured, double limit, std::string unit,
                    const std::string &explanation);
HealthCheck cannot_tell(std::string id, const std::string &why);

/// A check that failed by stretches of rows of the sample, with the times at which they begin.
HealthCheck failed_by(const Evidence &e, std::string id, const std::vector<RowRange> &rows,
                      const std::string &explanation);

/// Why a figure of the circle proves nothing here; empty where it does. A channel that does not
/// follow the magnet bends the circle of the other one, too.
std::string no_figures(const Evidence &e);

/// "0.5 s", or where the time is no number "sample 17".
std::string moment(const Recording &recording, std::size_t sample);

/// More than spikes are (criteria.h).
bool too_many(const Faults &faults, std::size_t samples);

} // namespace ada::health
