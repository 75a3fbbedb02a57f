// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Sentences about findings.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/result.h"

namespace ada {

/// The experiment that would tell an effect from its rivals; empty without rivals.
std::string separation(const Effect &effect, const std::vector<std::string> &rivals);

/// The cause in a sentence, with its numbers.
std::string explanation(const Finding &finding);

/// Of a reference whose degrees are not the shaft's: how far, and what else would look so.
std::string reference_scale_in_words(const Diagnosis &diagnosis);

/// A parameter for a person: value, error and unit; "vsin" for a channel.
std::string parameter_text(const ParameterInfo &info, double value, double std_error);

} // namespace ada
