// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the library knows by name: for suggestions, units and completion.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cli {

std::vector<std::string> effect_names();
/// Of a catalogue's effect; empty for one that is none.
std::vector<std::string> parameter_names(std::string_view effect);
/// As the option's numbers have it (quantity.h).
std::string parameter_unit(std::string_view effect, std::string_view parameter);
std::vector<std::string> figure_names();
/// "constant:rpm=600" and so on, one a kind.
std::vector<std::string> motion_examples();
std::vector<std::string> temperature_examples();
/// What `list --save` stored, for -s.
std::vector<std::string> stored_names();

/// What `text` begins with, up to the colon.
std::string_view kind_of(std::string_view text);
/// The same of each.
std::vector<std::string> kinds_of(const std::vector<std::string> &texts);

} // namespace cli
