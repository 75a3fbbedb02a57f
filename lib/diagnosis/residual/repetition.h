// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Whether what is left comes again where the shaft comes again.
#pragma once

#include <optional>

#include "diagnosis/conditions/observations.h"
#include "diagnosis/search/fit.h"

namespace ada {

/// Whether something is the same each time that the shaft passes a place. `once`: too few places
/// were passed twice; `untold`: they are enough, and do not tell.
enum class Recurrence { seen, once, untold, none };

/// Mean square of a channel, V^2, that is the same each time that the shaft passes a place, and the
/// standard error of that by chance: covariance of the residuals of one pass with those of the
/// others, over all places that were passed more than once. It may be negative. What goes on from
/// row to row within a pass, as noise of some colour and a slow drift do, is a function of the
/// place for a single pass, and of two it has no covariance. The error is that of arcs whose signs
/// are chance, and so of few arcs no smaller than their value over the root of their number. A rest
/// is one visit. `turn_rad`: after which place repeats, mechanical rad; `cell_rad`: width of a
/// place. nullopt: fewer than half of the places were passed twice. Cost: the samples, and 24 turns
/// each with each other.
struct Repeated {
  double v2, error_v2;
};
std::optional<Repeated> repeated_v2(const Observations &data, const ResidualColumns &rest,
                                    double turn_rad, double cell_rad);

/// Whether what a model takes of the squares that another leaves, it takes throughout: in the
/// middle of what stretches of the record gain, and at no speed less than nothing beyond its
/// errors. What repeats with the angle does so in most turns and at whatever speed the shaft
/// passes; a magnet that passes the bench once does not, nor does a tone that is a multiple of one
/// of the speeds. `data` in order of time; `clearly`: the middle of the stretches beyond its
/// errors, where nothing else has said so.
bool takes_throughout(const Observations &data, const ResidualColumns &with,
                      const ResidualColumns &without, bool clearly);

/// What goes on from one row to the next, V rms: the root of the mean product of a residual with
/// the one before. 0 where that is little beside the rest, or where the signs of the products do
/// not show it: of noise without memory they are as often negative, whatever its size at each row.
/// It asks few rows, and does not say what the residual goes with.
double goes_on_v(const ResidualColumns &rest);

} // namespace ada
