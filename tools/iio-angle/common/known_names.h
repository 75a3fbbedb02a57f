// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the library knows by name: for suggestions, units and completion.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "common/handles.h"
#include "common/spelling.h"

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
/// Calls open(), which opens what is stored as `name`; a failure over a name that is not stored
/// says what may have been meant.
template <class Open> auto open_stored(const std::string &name, const Open &open) {
  try {
    return open();
  } catch (const Failure &e) {
    const std::vector<std::string> known = stored_names();
    if (std::find(known.begin(), known.end(), name) != known.end())
      throw;
    throw Failure(e.exit_status(), e.what() + did_you_mean(name, known));
  }
}

/// What `text` begins with, up to the colon.
std::string_view kind_of(std::string_view text);
/// The parameters of the one of `texts` that begins with `kind`: "from" and "to" of
/// "ramp:from=60,to=3000".
std::vector<std::string> keys_of(const std::vector<std::string> &texts, std::string_view kind);
/// What each begins with.
std::vector<std::string> kinds_of(const std::vector<std::string> &texts);

} // namespace cli
