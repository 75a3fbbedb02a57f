// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What speaks for a cause and against it, apart from the search that asks.
#pragma once

#include <optional>
#include <string_view>

#include "diagnosis/search/search.h"

namespace ada {

/// Coordinates of a fit that an effect brings along.
std::size_t coordinates(const EffectInstance &e);

/// Value of a parameter that is chosen rather than fitted, such as an order; nothing where the
/// effect has none of this name and, where given, unit.
std::optional<double> chosen(const EffectInstance &e, std::string_view name,
                             std::string_view unit = {});

/// What an effect must be worth on held-out data beyond criteria::kLeastNats, for the freedom that
/// it has.
double penalty(const EffectInstance &e);

/// Part of the noise that an effect must explain. One that may come at any order or frequency meets
/// every small imperfection of the rest.
double least_of_noise(const Effect &effect);

/// Whether it is a function of the angle alone. A ripple of the motion is one, too, and what that
/// is to second order nobody knows.
bool of_the_angle(const Effect &effect);

/// Whether it moves the pair by more than the angle alone decides: with the speed, the time, the
/// temperature, the supply.
bool shows_beyond_angle(const Effect &effect);

/// An effect that does nothing yet, with what has to be chosen as it is where nobody does.
EffectInstance absent(const Effect &effect);

/// Whether a model has an effect.
bool holds(const Model &model, const Effect *effect);

/// Whether it changes the figure that the pair draws, whatever turns it.
bool shapes_the_figure(const Effect &effect);

/// Whether it lets VTEMP follow VCOS.
bool leaks(const EffectInstance &e);

/// Whether VTEMP follows VCOS by more than the model has it.
bool leak_unexplained(const Observations &train, const Model &model);

/// Whether what shows beside the pair measures an effect: then it need not stand out in the pair,
/// where others may look like it.
bool is_measured_aside(const Observations &train, const Model &model, std::size_t effect);

/// Ripples of the reference against even time that no cause of a model is.
std::vector<Ripple> unnamed_ripples(const Scene &scene, const Model &model);

/// Log likelihood of what stands beside the pair: VTEMP and the motion of the reference.
double side_evidence(const SearchData &data, const Model &model);

} // namespace ada
