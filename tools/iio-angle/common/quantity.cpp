// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/quantity.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace cli {

namespace {

/// A way to write a unit, and what it is worth in the one that is meant without any.
struct Spelling {
  std::string_view unit, written;
  double worth;
  bool takes_prefix = true;
};

constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr Spelling kSpellings[] = {{"s", "s", 1.0},
                                   {"s", "min", 60.0, false},
                                   {"s", "h", 3600.0, false},
                                   {"Hz", "Hz", 1.0},
                                   {"Hz", "Sps", 1.0},
                                   {"V", "V", 1.0},
                                   {"rpm", "rpm", 1.0},
                                   {"rpm", "deg/s", 1.0 / 6.0},
                                   {"rpm", "Hz", 60.0},
                                   {"deg", "deg", 1.0},
                                   {"deg", "\u00b0", 1.0},
                                   {"deg", "rad", kDegrees},
                                   {"C", "\u00b0C", 1.0, false},
                                   {"C", "degC", 1.0, false},
                                   {"C", "C", 1.0, false},
                                   {"1", "%", 0.01, false},
                                   {"1", "ppm", 1e-6, false}};

struct Prefix {
  std::string_view written;
  double worth;
};
constexpr Prefix kPrefixes[] = {{"p", 1e-12},     {"n", 1e-9},      {"u", 1e-6},
                                {"\u00b5", 1e-6}, {"\u03bc", 1e-6}, {"m", 1e-3},
                                {"k", 1e3},       {"M", 1e6},       {"G", 1e9}};

/// What a prefix at the end of the text is worth; nothing where it is none.
std::optional<double> prefix_of(std::string_view text) {
  if (text.empty())
    return 1.0;
  for (const Prefix &prefix : kPrefixes)
    if (text == prefix.written)
      return prefix.worth;
  return std::nullopt;
}

/// What stands behind the number, in the unit meant.
std::optional<double> worth_of(std::string_view tail, std::string_view unit) {
  if (const auto prefix = prefix_of(tail))
    return prefix;
  for (const Spelling &spelling : kSpellings) {
    if (spelling.unit != unit || !tail.ends_with(spelling.written))
      continue;
    const std::string_view before = tail.substr(0, tail.size() - spelling.written.size());
    const auto prefix = prefix_of(before);
    if (prefix && (before.empty() || spelling.takes_prefix))
      return *prefix * spelling.worth;
  }
  return std::nullopt;
}

std::string_view examples(std::string_view unit) {
  return unit == "s"     ? "a time, such as 10, 10s, 500ms or 2min"
         : unit == "Hz"  ? "a frequency, such as 10000, 10k or 1MHz"
         : unit == "V"   ? "a voltage, such as 0.5 or 500mV"
         : unit == "rpm" ? "a speed, such as 600 or 600rpm"
         : unit == "deg" ? "an angle, such as 0.1 or 0.1deg"
         : unit == "C"   ? "a temperature, such as 25 or 25C"
                         : "a number";
}

} // namespace

std::optional<double> parse_quantity(std::string_view text, std::string_view unit) {
  if (text.starts_with('+'))
    text.remove_prefix(1);
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || !std::isfinite(number))
    return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  if (text.starts_with(' '))
    text.remove_prefix(1);
  const auto worth = worth_of(text, unit);
  if (!worth)
    return std::nullopt;
  // A millionth is divided by a million rather than multiplied: 4us is 4e-6 to the last bit.
  const double parts = std::round(1.0 / *worth);
  const bool exact = *worth < 1.0 && std::abs(parts * *worth - 1.0) < 1e-9;
  return exact ? number / parts : number * *worth;
}

std::string not_a_quantity(std::string_view text, std::string_view unit) {
  return fmt::format("'{}' is not {}", text.substr(0, 60), examples(unit));
}

std::string with_plain_numbers(std::string_view text,
                               const std::function<std::string(std::string_view)> &unit_of) {
  std::size_t at = std::min(text.find(':'), text.size());
  std::string out(text.substr(0, at));
  while (at < text.size()) {
    out += text[at++]; // ':' or ','
    const std::size_t end = std::min(text.find(',', at), text.size());
    const std::size_t equals = std::min(text.find('=', at), end);
    const std::string unit = unit_of(text.substr(at, equals - at));
    out += text.substr(at, equals - at);
    for (at = equals; at < end;) {
      out += text[at++]; // '=' or '/'
      // A unit may hold the mark between values ("deg/s"): the longest piece that is a number wins.
      std::size_t to = end;
      auto value = parse_quantity(text.substr(at, to - at), unit);
      while (!value && to > at && (to = text.substr(0, to).rfind('/')) != text.npos && to > at)
        value = parse_quantity(text.substr(at, to - at), unit);
      if (!value || to == text.npos || to <= at)
        to = std::min(text.find('/', at), end), value = std::nullopt;
      out += value ? fmt::format("{}", *value) : std::string(text.substr(at, to - at));
      at = to;
    }
  }
  return out;
}

} // namespace cli
