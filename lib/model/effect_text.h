// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Effects as people write them, "stray-field:b=0.01,direction_deg=30", and the checks that every
// way into a model shares.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "model/effect.h"
#include "model/model.h"

namespace ada {

/// Reads "NAME" or "NAME:parameter=value,...". What is not given takes its fallback; a channel is
/// vsin, vcos, 0 or 1; "none" leaves a parameter without bounds out. Throws
/// Error(ADA4571_ERROR_INVALID_ARGUMENT) that lists the known names or parameters.
EffectInstance parse_effect(std::string_view text);

/// Appends to the model; throws Error(ADA4571_ERROR_INVALID_ARGUMENT) when it holds the effect
/// already at the same place, or its values contradict each other.
void add_effect(Model &model, EffectInstance instance);

/// Whether the parameter may be missing (NaN): a level without bounds, such as a clipping level, or
/// a channel where the effect may be on both.
bool may_be_absent(const ParameterInfo &parameter);

/// What is wrong with a value, "must be from -1 to 1"; empty when nothing is.
std::string check_parameter(const ParameterInfo &parameter, double value);

/// Whether `b` says the same thing as `a` again. Effects that sit at an order, a moment, a channel
/// or a frequency may be there several times, at different ones; others once.
bool repeats(const EffectInstance &a, const EffectInstance &b);

/// "a, b, c": the names of the catalogue, or of the parameters of one effect.
std::string known_effects();
std::string known_parameters(const EffectInfo &info);

/// Index of a parameter; parameters.size() when there is none of this name.
std::size_t find_parameter(const EffectInfo &info, std::string_view name);

} // namespace ada
