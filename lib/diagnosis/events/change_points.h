// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The moment of a step. A search sees thinned samples only; the moment is looked for once more in
// all of them, held out or not, since an event belongs to the capture and not to a part of it.
#pragma once

#include "diagnosis/conditions/observations.h"
#include "model/model.h"

namespace ada {

/// Whether an effect of the signal begins at a moment that is looked for.
bool has_moment(const Effect &effect);

/// The model with the moment of every effect from `first` on that has one moved to where all the
/// samples nearby see it.
Model with_exact_moments(const Scene &scene, Model model, std::size_t first);

/// Samples within `part` of the record about a moment, across what the training part leaves out
/// there: a long standstill may lie within one turn that is held back.
std::vector<std::uint32_t> samples_near(const Scene &scene, double moment, double part);

} // namespace ada
