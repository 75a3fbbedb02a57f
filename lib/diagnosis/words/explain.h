// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Sentences about findings.
#pragma once

#include <string>
#include <vector>

#include "diagnosis/words/result.h"

namespace ada {

/// The experiment that would tell an effect from its rivals; empty without rivals.
std::string separation(const Effect &effect, const std::vector<std::string> &rivals);

/// The cause in a sentence, with its numbers.
std::string explanation(const Finding &finding);

/// How a reference goes away from the shaft, and what else would look so.
std::string in_words(const ReferenceCourse &course);

/// A parameter for a person: value, error and unit; "vsin" for a channel.
std::string parameter_text(const ParameterInfo &info, double value, double std_error);

} // namespace ada
