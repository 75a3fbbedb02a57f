// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "import/units.h"

#include <algorithm>
#include <numbers>

#include "base/text.h"

namespace ada {

namespace {

struct Unit {
  Quantity quantity;
  double factor;
  std::string_view words; ///< between blanks
};

constexpr Unit kUnits[] = {
    {Quantity::time, 1.0, " s sec secs second seconds sekunde sekunden "},
    {Quantity::time, 1e-3, " ms msec millisecond milliseconds "},
    {Quantity::time, 1e-6, " us usec \xC2\xB5s \xCE\xBCs \xB5s microsecond microseconds "},
    {Quantity::time, 1e-9, " ns nsec nanosecond nanoseconds "},
    {Quantity::time, 60.0, " min minute minutes "},
    {Quantity::volts, 1.0, " v volt volts "},
    {Quantity::volts, 1e-3, " mv millivolt millivolts "},
    {Quantity::volts, 1e-6, " uv \xC2\xB5v \xCE\xBCv \xB5v microvolt microvolts "},
    {Quantity::degrees, 1.0, " deg degs degree degrees \xC2\xB0 \xB0 "},
    {Quantity::degrees, 180.0 / std::numbers::pi, " rad rads radian radians "},
    {Quantity::degrees, 360.0, " turn turns rev revs revolution revolutions "},
};

bool among(std::string_view words, const std::string &word) {
  return !word.empty() && word.find(' ') == word.npos &&
         words.find(" " + word + " ") != words.npos;
}

/// Without blanks and quotes around it.
std::string trimmed(std::string_view text) {
  const auto outer = text.find_first_not_of(" \t\"'");
  return outer == text.npos
             ? std::string()
             : std::string(text.substr(outer, text.find_last_not_of(" \t\"'") - outer + 1));
}

} // namespace

std::string folded(std::string_view text) {
  std::string out = trimmed(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return out;
}

std::string unit_word(std::string_view text) {
  std::string word = trimmed(text);
  if (word.size() > 2 && ((word.front() == '(' && word.back() == ')') ||
                          (word.front() == '[' && word.back() == ']')))
    word = trimmed(std::string_view(word).substr(1, word.size() - 2));
  return word;
}

std::optional<double> unit_factor(Quantity quantity, std::string_view unit) {
  const std::string word = folded(unit_word(unit));
  for (const Unit &known : kUnits)
    if (known.quantity == quantity && among(known.words, word))
      return known.factor;
  return std::nullopt;
}

bool is_sample_count(std::string_view word) {
  return among(" sequence sample samples index number no nr n # ", folded(unit_word(word)));
}

bool is_unit(std::string_view word) {
  const std::string text = folded(unit_word(word));
  return is_sample_count(text) || std::any_of(std::begin(kUnits), std::end(kUnits),
                                              [&](const Unit &u) { return among(u.words, text); });
}

NameAndUnit split_unit(std::string_view text) {
  text = trim(text);
  while (text.size() >= 2 && text.front() == '"' && text.back() == '"')
    text = trim(text.substr(1, text.size() - 2));
  if (!text.empty() && (text.back() == ')' || text.back() == ']')) {
    const auto open = text.rfind(text.back() == ')' ? '(' : '[');
    if (open != text.npos)
      return {std::string(trim(text.substr(0, open))), unit_word(text.substr(open))};
  }
  const auto cut = text.find_last_of("_/ ,");
  if (cut != text.npos && cut > 0 && is_unit(text.substr(cut + 1)) &&
      !is_sample_count(text.substr(cut + 1)))
    return {std::string(trim(text.substr(0, cut))), unit_word(text.substr(cut + 1))};
  return {std::string(text), {}};
}

} // namespace ada
