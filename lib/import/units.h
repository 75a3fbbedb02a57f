// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Units and names as oscilloscopes and acquisition programs write them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace ada {

enum class Quantity { time, volts, degrees };

/// Factor to seconds, volts or degrees; nothing for a word that is no unit of the quantity.
std::optional<double> unit_factor(Quantity quantity, std::string_view unit);

/// Whether the word is a unit, or says that a column counts samples.
bool is_unit(std::string_view word);
bool is_sample_count(std::string_view word);

/// "Channel A (mV)", "time_ms", "VSIN [V]": a name and its unit, which is empty where none is known.
struct NameAndUnit {
  std::string name, unit;
};
NameAndUnit split_unit(std::string_view text);

/// "(mV)": the word as it is written, without the brackets.
std::string unit_word(std::string_view text);

/// Lower case, without blanks and quotes at the ends.
std::string folded(std::string_view text);

} // namespace ada
