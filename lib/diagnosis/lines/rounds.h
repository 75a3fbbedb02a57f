// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What repeats with the angle, as lines over time: how often the shaft comes round, how evenly, and
// whether a line is at an order of it.
#pragma once

#include "diagnosis/criteria.h"
#include "diagnosis/lines/line.h"

namespace ada {

/// Below this what comes with time cannot be told from what comes with the angle, but for what is
/// faster than any angle.
constexpr double kFewestRounds = criteria::kFewestTurnsToRepeat;

/// Of the resolution: what lies nearer to an order of the turn is not told from it. A line's main
/// lobe ends at 1, its error beside another line's lobes included at 3.
constexpr double kOrderWidth = 3.0;

/// How often the shaft comes round, whatever its sense: by a turn, or to and fro over a part of
/// one.
double rounds_of(const Residual &r);

/// Turns a second of a shaft that comes round at even intervals, however it turns within each: what
/// repeats with its angle then repeats in time. 0: it does not, or came round too seldom to tell.
double comes_round(const Residual &r);

/// The order of the turn that a frequency is near at a speed at which the capture dwells; 0: none.
int order_near(const Residual &r, double frequency, double resolution);

/// Whether a line in Hz is more than an order of the turn beside it, which may grow and fall over
/// the record: it leaves more than half of what both take.
bool told_from_order(const Residual &r, int order, double frequency);

/// Hz at which a shaft that goes to and fro evenly comes back: whatever repeats with its angle is
/// then a sum of lines at the multiples. 0: it moves otherwise, over whole turns, or too seldom for
/// the multiples to lie apart.
double comes_back(const Residual &r);

/// Whether what repeats with the angle may make a line of this frequency while the shaft goes to
/// and fro: of an order n over a way of amplitude A it makes such up to n A, and little beyond (the
/// Bessel functions of a frequency modulation).
bool of_way_there_and_back(const Residual &r, double back_hz, double frequency);

/// Hz at which a frequency is seen in samples at an even rate, and the order of a shaft that comes
/// round at even intervals which is seen at a frequency: the nearest one, or one that the
/// sampling folds there.
double seen_at_hz(const Residual &r, double frequency);
int order_seen_at(const Residual &r, double round_hz, double frequency);

/// A line at an order of a steady rotation is no tone when the residual follows the angle as well.
bool turns_with_shaft(const Residual &r, int order, const Line &tone);

/// Highest order of the turn that a named cause may have.
double highest_named(const Residual &r);

/// Whether the shaft came round too seldom to tell a tone from what repeats with the angle: at one
/// speed the two are one but for the width of a line.
bool too_few_rounds_for_lines(const Residual &r);

} // namespace ada
