// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "base/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace ada {

std::string_view trim(std::string_view text) {
  const auto first = std::min(text.find_first_not_of(" \t"), text.size());
  const auto last = text.find_last_not_of(" \t");
  return text.substr(first, last == text.npos ? 0 : last - first + 1);
}

std::string excerpt(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string out = "'";
  for (const char c : text.substr(0, kLongest))
    out += (c >= 0x20 && c < 0x7f) ? c : '?';
  return out + (text.size() > kLongest ? "...'" : "'");
}

std::string printable(std::string_view text) {
  constexpr char kHex[] = "0123456789abcdef";
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : 0);
    const bool eight_bits = byte == 0xc2 && next >= 0x80 && next < 0xa0; // U+0080 to U+009F
    if (byte == '\n')
      out += "\\n";
    else if (byte == '\t')
      out += "\\t";
    else if (byte < 0x20 || byte == 0x7f || eight_bits)
      out.append({'\\', 'x', kHex[(eight_bits ? next : byte) >> 4],
                  kHex[(eight_bits ? next : byte) & 15]});
    else
      out += text[i];
    i += eight_bits;
  }
  return out;
}

std::string shortest(double value) {
  std::array<char, 40> text;
  char *const last = text.data() + text.size();
  const double size = std::fabs(value);
  // "0.0005" rather than "5e-04": the shortest of all is not what a person would write.
  const bool plain = value == 0 || (size >= 1e-6 && size < 1e15);
  const auto end = plain ? std::to_chars(text.data(), last, value, std::chars_format::fixed).ptr
                         : std::to_chars(text.data(), last, value).ptr;
  return {text.data(), end};
}

std::string in_full(double value) {
  std::array<char, 400> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed);
  return {text.data(), end.ptr};
}

std::string times_text(std::size_t count) {
  return count == 1 ? "once" : std::to_string(count) + " times";
}

std::string moment_text(double time_s) {
  std::array<char, 400> text; // the longest double and six places
  const char *const first = text.data();
  const char *end =
      std::to_chars(text.data(), text.data() + text.size(), time_s, std::chars_format::fixed, 6)
          .ptr;
  if (std::isfinite(time_s)) {
    while (end[-1] == '0')
      --end;
    end -= end[-1] == '.';
  }
  const std::string_view number(first, end);
  return std::string(number == "-0" ? "0" : number) + " s";
}

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

} // namespace ada
