// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Numbers as people write them: 10s, 500ms, 10k, 1MHz, 600rpm. The one place that knows units.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace cli {

/// A number with an optional prefix (p n u m k M G) and an optional unit, in the unit that is
/// meant without one: "s", "Hz", "V", "rpm", "deg", "C" (degrees Celsius), or "1" and any other for
/// plain numbers. Nothing when it is not that.
std::optional<double> parse_quantity(std::string_view text, std::string_view unit);

/// The sentence for what is none: "'5 km' is no number of seconds (10, 10s, 500ms)".
std::string not_a_quantity(std::string_view text, std::string_view unit);

/// The numbers of "kind:key=value,key=value/value" in their plain units, the rest as it is.
/// `unit_of` gives the unit of a key.
std::string with_plain_numbers(std::string_view text,
                               const std::function<std::string(std::string_view)> &unit_of);

} // namespace cli
