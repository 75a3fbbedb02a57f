// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Two signals that are no sine and cosine of one angle: without a reference there is then no angle
// at all, and nothing that hangs on one can be looked for.
#pragma once

#include <string>
#include <vector>

namespace ada {

/// Why the pair has no angle of its own: the scatter about the best ellipse reaches from the curve
/// to its centre (why_no_circle of calibration/guards.h), and the pair also comes near that centre,
/// or it does not go all round it: through a cloud of readings that stand still a curve passes with
/// its centre outside. A length that wanders scatters, too, yet keeps its angle: it goes round, and
/// never comes to nothing. Or that most readings stand in one place, and the few others lie on no
/// circle. Empty where there is one.
std::string why_no_angle(const std::vector<double> &vsin, const std::vector<double> &vcos);

/// Whether the pair draws as much of a circle as a diagnosis needs, and has an angle of its own.
bool draws_circle(const std::vector<double> &vsin, const std::vector<double> &vcos);

} // namespace ada
