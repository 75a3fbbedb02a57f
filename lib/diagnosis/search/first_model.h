// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Where a fit begins, and the noise that it is measured against.
#pragma once

#include "diagnosis/conditions/observations.h"
#include "model/model.h"
#include "recording/capture.h"

namespace ada {

/// Noise that the capture should have, V rms of a channel: what it states, with the converter's
/// steps on top; without a statement (`stated` false) what the data show from sample to sample.
double expected_noise(const Capture &capture, const Scene &scene, bool &stated);

/// Amplitude, offsets and zero angle that start the fit, and the wiring that was seen before any;
/// `given` null: of the application note's model.
Model first_model(const Scene &scene, const Model *given);

/// The model with what every pair has, absent as yet: it is fitted from the start, and goes when
/// nothing speaks for it.
Model with_expected(Model model);

} // namespace ada
