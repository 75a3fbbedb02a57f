// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/metadata.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/angle.h"
#include "base/text.h"
#include "base/utf8.h"

namespace ada {

namespace {

using Meta = CaptureMetadata;

/// One known key: how it is read (returns what is wanted instead, empty when it was taken) and how
/// it is written (nothing when the field is unset).
struct Key {
  std::string_view name;
  std::string (*read)(Meta &, std::string_view);
  std::optional<std::string> (*write)(const Meta &);
};

/// Reads a number in [least, most].
template <class Field>
std::string read_number(std::string_view text, Field &field, double least, double most) {
  const auto value = parse_number(text);
  if (value && *value >= least && *value <= most) {
    field = *value;
    return {};
  }
  return "must be a number from " + shortest(least) + " to " + shortest(most);
}

/// No number that is a divisor is so small that what it divides becomes infinite.
constexpr double kLeastVolts = 1e-6, kLeastRate = 1e-6, kLeastBits = 1;

std::string read_periods(Meta &meta, std::string_view text) {
  const auto value = parse_number(text);
  if (!value || *value < 1 || *value > kMostPeriodsATurn || *value != std::floor(*value))
    return "must be a whole number from 1 to 65536";
  meta.periods_per_turn = static_cast<int>(*value);
  return {};
}

std::string read_gain_control(Meta &meta, std::string_view text) {
  if (text != "on" && text != "off")
    return "must be on or off";
  meta.gain_control = text == "on";
  return {};
}

std::optional<std::string> show(const std::optional<double> &value) {
  return value ? std::optional(shortest(*value)) : std::nullopt;
}

std::optional<std::string> show(const std::string &text) {
  return text.empty() ? std::nullopt : std::optional(text);
}

/// In the order in which the keys are written.
constexpr std::array kKeys = {
    Key{"supply_v",
        [](Meta &m, std::string_view v) { return read_number(v, m.supply_v, kLeastVolts, 100); },
        [](const Meta &m) { return std::optional(shortest(m.supply_v)); }},
    Key{"periods_per_turn", read_periods,
        [](const Meta &m) { return std::optional(std::to_string(m.periods_per_turn)); }},
    Key{"gain_control", read_gain_control,
        [](const Meta &m) {
          return m.gain_control ? std::optional<std::string>(*m.gain_control ? "on" : "off")
                                : std::nullopt;
        }},
    Key{"noise_rms_v",
        [](Meta &m, std::string_view v) { return read_number(v, m.noise_rms_v, 0, 100); },
        [](const Meta &m) { return show(m.noise_rms_v); }},
    Key{"sample_rate_hz",
        [](Meta &m, std::string_view v) {
          return read_number(v, m.sample_rate_hz, kLeastRate, 1e9);
        },
        [](const Meta &m) { return show(m.sample_rate_hz); }},
    Key{"adc_bits",
        [](Meta &m, std::string_view v) { return read_number(v, m.adc_bits, kLeastBits, 64); },
        [](const Meta &m) { return show(m.adc_bits); }},
    Key{"adc_reference_v",
        [](Meta &m, std::string_view v) {
          return read_number(v, m.adc_reference_v, kLeastVolts, 1000);
        },
        [](const Meta &m) { return show(m.adc_reference_v); }},
    Key{"serial",
        [](Meta &m, std::string_view v) {
          m.serial = v;
          return std::string();
        },
        [](const Meta &m) { return show(m.serial); }},
    Key{"origin",
        [](Meta &m, std::string_view v) {
          m.origin = v;
          return std::string();
        },
        [](const Meta &m) { return show(m.origin); }},
};

const Key *find_key(std::string_view name) {
  const auto *it =
      std::find_if(kKeys.begin(), kKeys.end(), [&](const Key &k) { return k.name == name; });
  return it == kKeys.end() ? nullptr : it;
}

bool has_control(std::string_view text) {
  return std::any_of(text.begin(), text.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte < 0x20 && byte != '\t') || byte == 0x7f;
  });
}

bool padded(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  return !text.empty() && (blank(text.front()) || blank(text.back()));
}

} // namespace

bool is_known_metadata(std::string_view key) {
  return find_key(key) != nullptr;
}

std::string assign_metadata(CaptureMetadata &meta, std::string_view key, std::string_view value) {
  if (key.empty())
    return "a key is empty";
  if (padded(key) || has_control(key) || key.find('=') != key.npos || key.front() == '#')
    return "the key " + excerpt(key) + " holds a character that a key cannot have";
  if (padded(value) || has_control(value))
    return "the value of " + excerpt(key) + " is not one plain line of text";
  if (!is_utf8(key) || !is_utf8(value))
    return "the line of " + excerpt(key) + " is not in UTF-8: " + excerpt(value);
  const Key *known = find_key(key);
  if (known == nullptr) {
    meta.other.emplace_back(key, value);
    return {};
  }
  const std::string wanted = known->read(meta, value);
  return wanted.empty() ? wanted : std::string(key) + " " + wanted + ", not " + excerpt(value);
}

std::vector<std::pair<std::string, std::string>> metadata_entries(const CaptureMetadata &meta) {
  std::vector<std::pair<std::string, std::string>> entries;
  for (const Key &key : kKeys)
    if (auto value = key.write(meta))
      entries.emplace_back(key.name, std::move(*value));
  entries.insert(entries.end(), meta.other.begin(), meta.other.end());
  return entries;
}

std::optional<std::string> find_metadata(const CaptureMetadata &meta, std::string_view key) {
  if (const Key *known = find_key(key))
    return known->write(meta);
  for (const auto &[name, value] : meta.other)
    if (name == key)
      return value;
  return std::nullopt;
}

std::string check_metadata(const CaptureMetadata &meta) {
  CaptureMetadata scratch;
  for (const auto &[key, value] : metadata_entries(meta))
    if (std::string problem = assign_metadata(scratch, key, value); !problem.empty())
      return problem;
  return {};
}

} // namespace ada
