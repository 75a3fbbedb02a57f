// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Small pieces of text handling that every reader and writer shares; independent of the locale.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace ada {

/// Without blanks and tabs at both ends. The result points into `text` even when it is empty.
std::string_view trim(std::string_view text);

/// `text` short and printable, in quotes, for a message; everything else becomes '?'.
std::string excerpt(std::string_view text);

/// `text` on one line and without power over a terminal: control characters, also those of eight
/// bits in UTF-8, as \n, \t or \xNN; everything else as it is.
std::string printable(std::string_view text);

/// Decimal text with no more digits than it takes to read back the same double.
std::string shortest(double value);

/// A moment of a recording, "0.5 s" or "1760000000.25 s": to the microsecond, whatever the origin.
std::string moment_text(double time_s);

/// "once", or "5 times".
std::string times_text(std::size_t count);
/// The shortest text without an exponent that reads back as the same number.
std::string in_full(double value);

/// The whole text as a finite number, or nothing.
std::optional<double> parse_number(std::string_view text);

} // namespace ada
