// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The moment of a step. A search sees thinned samples only; the moment is looked for once more in
// all of them, held out or not, since an event belongs to the capture and not to a part of it.
#pragma once

#include "diagnosis/observations.h"
#include "model/model.h"

namespace ada {

/// Whether an effect of the signal begins at a moment that is looked for.
bool has_moment(const Effect &effect);

/// The model with the moment of every effect from `first` on that has one moved to where all the
/// samples nearby see it.
Model with_exact_moments(const Scene &scene, Model model, std::size_t first);

/// Whether the data bear out that an effect with a moment begins at once there: within a turn
/// before it nothing of it is seen, within a turn after it all, and the speed does not change there
/// as well. What comes slowly, or with the speed, is no step. True where too little is seen to say.
bool begins_at_once(const Scene &scene, const Model &model, std::size_t effect);

} // namespace ada
