// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Starting circle for the ellipse fit, by Taubin's algebraic method (G. Taubin, IEEE PAMI 13,
// 1991; in the Newton form of N. Chernov, "Circular and Linear Regression", 2010): needs no start
// of its own and is almost unbiased on short arcs, where the plain algebraic fit shrinks.
#pragma once

#include <span>

#include "conversion/ellipse.h"

namespace ada {

/// `use[i] == 0` leaves sample i out; an empty span uses all. The result has k = d = 0 and an
/// amplitude of 0 when the points lie on a line or in one point.
EllipseParameters circle_start(std::span<const double> vsin, std::span<const double> vcos,
                               std::span<const unsigned char> use = {});

/// A start that up to half of the places may be wrong for, however many samples stand at one of
/// them: least median of squares (P. J. Rousseeuw, JASA 79, 1984) over circles through three
/// places. A place is a cell of a grid over what the 10 % quantiles of both channels bound and as
/// much again to either side; it counts once. Amplitude 0 where fewer than twelve cells hold
/// samples.
EllipseParameters circle_of_most_places(std::span<const double> vsin, std::span<const double> vcos);

} // namespace ada
