// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The report's sentences and numbers, as plain text (not yet escaped).
#pragma once

#include <string>

#include "diagnosis/result.h"

namespace ada {

/// The verdict in one sentence.
std::string headline(const Diagnosis &diagnosis);

/// "amplitude mismatch" of "amplitude-mismatch".
std::string plain_name(std::string_view id);

/// A parameter for a person: digits down to the second of its error, small seconds and volts with
/// a prefix, VSIN or VCOS for a channel.
struct Shown {
  std::string value, error, unit;
};
Shown show(const ParameterInfo &info, double value, double std_error);

std::string millivolts(double volts);
std::string degrees(double deg);

/// "one cause", "2 causes".
std::string counted(std::size_t n, const std::string &noun);

} // namespace ada
