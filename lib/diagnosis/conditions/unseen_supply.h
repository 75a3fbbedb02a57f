// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A supply that nobody recorded, seen through the radius of the pair.
#pragma once

#include <optional>

#include "diagnosis/conditions/observations.h"
#include "model/model.h"
#include "recording/capture.h"

namespace ada {

/// Both outputs follow the supply about zero volts, not about their middle, so a moving supply
/// moves the radius by an amount that depends on the angle in one known way. Where that explains
/// what the radius does, and a moving gain or offset does not, gives the capture with the VDD
/// column that it must have had. With a reference, which tells more about the pair, only VTEMP is
/// freed of the supply. Nothing for a capture with VDD.
std::optional<Capture> with_unseen_supply(const Capture &capture);

/// VTEMP follows the supply as well. What a model leaves over along the absolute voltages is what
/// the supply did: with a reference and a supply that the search found, VTEMP freed of it. Nothing
/// where that does not quieten it.
std::optional<Capture> with_free_vtemp(const Capture &capture, const Scene &scene,
                                       const Model &model);

/// Whether a supply that only the radius shows, of this rms as a fraction, accounts for what the
/// radius does beyond noise of `noise_v`. Otherwise it would hide what nothing explains.
bool accounts_for_radius(const Observations &data, const Model &model, double rms_fraction,
                         double noise_v);

} // namespace ada
