// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <string>
#include <string_view>

namespace ada {

/// The same TOML in ASCII, line by line: letters beyond it become escapes in "strings" and '?' in
/// comments. Give toml::parse() this and not the file of a user: toml++ up to 3.3 runs into
/// undefined behaviour on U+00A1 to U+0499 where it looks for a blank (is_unicode_whitespace()
/// holds them for impossible). Throws Error(ADA4571_ERROR_FORMAT) "file:line:column: why" for
/// letters in other places, for bytes that are no UTF-8, and for what this project's files do not
/// have: strings of several lines, and brackets or dotted keys nested so deeply that toml++, which
/// calls itself for each, could run out of stack.
std::string ascii_toml(std::string_view text, const std::string &shown);

} // namespace ada
