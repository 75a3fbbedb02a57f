// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/option_checks.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "common/quantity.h"
#include "common/spelling.h"

namespace cli {

namespace {

template <class Sound>
CLI::Validator quantity(const char *unit, const Sound &sound, const std::string &limits,
                        const std::string &description) {
  return {[=](std::string &text) -> std::string {
            const auto value = parse_quantity(text, unit);
            if (!value)
              return not_a_quantity(text, unit);
            if (!sound(*value))
              return fmt::format("'{}' is not {}", text, limits);
            text = fmt::format("{}", *value);
            return {};
          },
          description};
}

std::string listed(const std::vector<std::string> &words, const char *last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? last : ", ") + words[i];
  return text;
}

const std::vector<std::string> kCaptures = {".csv", ".sigmf-meta"};

bool is_named(const std::string &path, const std::vector<std::string> &endings) {
  return std::any_of(endings.begin(), endings.end(), [&](const std::string &ending) {
    return path.size() > ending.size() && path.ends_with(ending);
  });
}

std::string no_name_for(const std::string &path, const std::vector<std::string> &endings,
                        const char *what) {
  return fmt::format("'{}' is no name for {}: let it end in {}", path, what,
                     listed(endings, " or "));
}

} // namespace

CLI::Validator positive(const char *unit) {
  return quantity(
      unit, [](double x) { return x > 0; }, "above 0", "POSITIVE");
}

CLI::Validator from_zero(const char *unit) {
  return quantity(
      unit, [](double x) { return x >= 0; }, "0 or above", "NONNEGATIVE");
}

CLI::Validator between(double low, double high, const char *unit) {
  const std::string limits = fmt::format("from {:g} to {:g}", low, high);
  return quantity(
      unit, [=](double x) { return x >= low && x <= high; }, limits,
      fmt::format("in [{:g} - {:g}]", low, high));
}

CLI::Validator whole(std::uint64_t low, std::uint64_t high) {
  const bool bounded = high != std::numeric_limits<std::uint64_t>::max();
  const std::string limits = bounded ? fmt::format("a whole number from {} to {}", low, high)
                                     : fmt::format("a whole number, {} or above", low);
  return {[=](std::string &text) -> std::string {
            // As digits first: a double does not hold all of 64 bits.
            std::uint64_t number = 0;
            const char *end = text.data() + text.size();
            const auto [stop, error] = std::from_chars(text.data(), end, number);
            const bool digits = !text.empty() && stop == end;
            if (digits && error == std::errc::result_out_of_range)
              return fmt::format("'{}' is above {}", text, high);
            const double value = parse_quantity(text, "1").value_or(-1.0);
            constexpr double kExact = 9007199254740992.0; // 2^53
            if (!digits && !(value >= 0 && value == std::floor(value) && value <= kExact))
              return fmt::format("'{}' is not {}", text, limits);
            number = digits ? number : static_cast<std::uint64_t>(value);
            if (number < low || number > high)
              return fmt::format("'{}' is not {}", text, limits);
            text = std::to_string(number);
            return {};
          },
          bounded   ? fmt::format("in [{} - {}]", low, high)
          : low > 0 ? "POSITIVE"
                    : "NONNEGATIVE"};
}

CLI::Validator one_of(std::vector<std::string> words, const char *what) {
  const std::string description = "{" + CLI::detail::join(words, ",") + "}";
  return {[words = std::move(words), what](std::string &text) -> std::string {
            if (std::find(words.begin(), words.end(), text) != words.end())
              return {};
            return fmt::format("'{}' is {}{}", text,
                               *what ? fmt::format("no {}", what) : "not " + listed(words, " or "),
                               did_you_mean(text, words));
          },
          description};
}

CLI::Validator ends_in(std::vector<std::string> endings, const char *what) {
  return {[endings = std::move(endings), what](std::string &path) -> std::string {
            return wrong_ending(path, endings, what);
          },
          ""};
}

CLI::Validator capture_name() {
  // What is written in place is not replaced, but a capture must still say which form it has.
  return {[](std::string &path) -> std::string {
            if (path == "-" || path.ends_with(".sigmf-data") || is_named(path, kCaptures))
              return {};
            return no_name_for(path, kCaptures, "a capture");
          },
          ""};
}

std::string wrong_ending(const std::string &path, const std::vector<std::string> &endings,
                         const char *what) {
  std::error_code ignored;
  const auto kind = std::filesystem::status(path, ignored).type();
  const bool in_place = path == "-" || (kind != std::filesystem::file_type::regular &&
                                        kind != std::filesystem::file_type::not_found);
  return in_place || is_named(path, endings) ? "" : no_name_for(path, endings, what);
}

} // namespace cli
