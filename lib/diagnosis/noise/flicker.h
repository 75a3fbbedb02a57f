// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Flicker noise in the spectrum of a record.
#pragma once

#include "diagnosis/anonymous/anonymous.h"
#include "diagnosis/conditions/observations.h"

namespace ada {

/// The corner against white noise, the rms below it, and the nats that it is worth; all 0: none.
struct Flicker {
  double corner_hz = 0.0, rms_v = 0.0, nats = 0.0;
};

/// Of both channels alike, as likely in every octave as its spectrum has it: by Whittle's
/// likelihood of a density w (1 + corner / f) against a white one. Without a reference, of what
/// lies along the radius.
Flicker flicker_of(const Observations &whole, bool has_reference, const Model &model,
                   const Anonymous &left);

} // namespace ada
