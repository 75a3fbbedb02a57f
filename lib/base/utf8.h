// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <cstddef>
#include <string_view>

namespace ada {

struct Utf8Character {
  char32_t code = 0;
  std::size_t bytes = 0; ///< 0: this is no UTF-8
};

/// The character beyond ASCII that begins at `at`.
Utf8Character utf8_at(std::string_view text, std::size_t at);

/// Whether the whole text is UTF-8, plain ASCII included.
bool is_utf8(std::string_view text);

} // namespace ada
