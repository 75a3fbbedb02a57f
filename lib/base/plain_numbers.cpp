// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/plain_numbers.h"

#include <algorithm>
#include <string_view>

namespace ada {

namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Digits, a point and digits, "e+", two digits.
struct Number {
  std::string_view whole, fraction;
  std::size_t exponent = 0, length = 0;
};

std::string_view digits_at(std::string_view text) {
  return text.substr(0, static_cast<std::size_t>(
                            std::find_if_not(text.begin(), text.end(), is_digit) - text.begin()));
}

Number number_at(std::string_view text) {
  Number out;
  out.whole = digits_at(text);
  std::size_t at = out.whole.size();
  if (at > 0 && at < text.size() && text[at] == '.') {
    out.fraction = digits_at(text.substr(at + 1));
    at += 1 + out.fraction.size();
  }
  const std::string_view power = text.substr(at);
  if (out.whole.empty() || !power.starts_with("e+") || digits_at(power.substr(2)).size() != 2)
    return {};
  out.exponent = static_cast<std::size_t>((power[2] - '0') * 10 + (power[3] - '0'));
  out.length = at + 4;
  return out;
}

/// Whether a character next to a number makes it a part of a word or of a file's name.
bool joins(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '/';
}

} // namespace

std::string in_plain_numbers(const std::string &sentence) {
  constexpr std::size_t kMostDigits = 15;
  std::string out;
  const std::string_view text = sentence;
  for (std::size_t i = 0; i < text.size();) {
    const bool inside = i > 0 && (joins(text[i - 1]) || text[i - 1] == '.');
    const Number n = inside || !is_digit(text[i]) ? Number{} : number_at(text.substr(i));
    const std::size_t end = i + n.length;
    const bool joined =
        end < text.size() &&
        (joins(text[end]) || (text[end] == '.' && end + 1 < text.size() && joins(text[end + 1])));
    if (n.length == 0 || joined || n.fraction.size() > n.exponent ||
        n.whole.size() + n.exponent > kMostDigits) {
      out += text[i++];
      continue;
    }
    out += n.whole;
    out += n.fraction;
    out.append(n.exponent - n.fraction.size(), '0');
    i = end;
  }
  return out;
}

} // namespace ada
