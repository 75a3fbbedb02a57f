// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <string>

namespace ada {

/// A sentence with its large numbers as a person writes them: "1280 mV" for "1.28e+03 mV". A
/// number of more than fifteen digits, and whatever is a part of a word, stays as it is.
std::string in_plain_numbers(const std::string &sentence);

} // namespace ada
