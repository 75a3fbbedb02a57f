// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The report's sentences and numbers, as plain text (not yet escaped). Causes keep the names that
// commands take.
#pragma once

#include <string>

#include "diagnosis/words/result.h"

namespace ada {

/// The verdict in one sentence.
std::string headline(const Diagnosis &diagnosis);

/// "the application note's model", or the name of another that was given.
std::string baseline_words(const Diagnosis &diagnosis);

/// What an axis of the budget means, for somebody who sees the word for the first time.
std::string meaning(Axis axis, bool has_reference);

/// A parameter for a person: digits down to the second of its error, small seconds and volts with
/// a prefix, VSIN or VCOS for a channel.
struct Shown {
  std::string value, error, unit;
  /// "0.0200 ± 0.0001 V"
  std::string in_full() const;
};
Shown show(const ParameterInfo &info, double value, double std_error);

std::string millivolts(double volts);
std::string degrees(double deg);

/// "before \u2192 after", or the one where they are the same.
std::string change(const std::string &before, const std::string &after);

/// "one cause", "2 causes".
std::string counted(std::size_t n, const std::string &noun);

/// With a capital letter and a stop.
std::string sentence(std::string text);
/// A sentence without its stop, to be followed by one.
std::string without_stop(std::string text);

} // namespace ada
