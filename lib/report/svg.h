// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// From gnuplot's SVG to SVG that lives inside the page: colours by name, no ids, text for readers
// that cannot see.
#pragma once

#include <string>
#include <string_view>

namespace ada {

/// Text for HTML, attributes included; control characters become blanks.
std::string html_escape(std::string_view text);

/// Colours of the scripts. Each stands for a variable of the page's style sheet, which gives it a
/// value for light, dark and print.
inline constexpr const char *kInk = "'#010101'";
inline constexpr const char *kMuted = "'#020202'";
inline constexpr const char *kGrid = "'#030303'";
inline constexpr const char *kBefore = "'#040404'";
inline constexpr const char *kAfter = "'#050505'";
inline constexpr const char *kMeasured = "'#060606'";
inline constexpr const char *kFloor = "'#070707'";
inline constexpr const char *kPale = "'#080808'";
inline constexpr const char *kSecond = "'#090909'";

/// Makes one drawing ready for the page. `label` says what it shows. Throws Error(IO) where the
/// text is no drawing.
std::string inline_svg(std::string_view drawing, std::string_view label);

/// The marks that drawings refer to; once in a page.
std::string svg_marks();

} // namespace ada
