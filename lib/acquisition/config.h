// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Stored configuration: what one sensor is connected to, so that its name is all a user needs.
//
//   [source]                       every key may be absent
//   uri = "local:"
//   device = "ad7380"              id, label or name
//   sin = "vsin"                   channel by id, name or label; likewise cos, temp, vdd
//   trigger = "timer0"
//   sample_rate_hz = 10000.0
//   supply_v = 5.0
//   periods_per_turn = 2
//   [pins]
//   gc = "ada4571-gc"              line name, or "gpiochip0:17"; likewise pd
//   gc_active_low = false          likewise pd_active_low
//   [calibration]
//   file = "sensor.toml"           relative to the folder of the configuration
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/iio_source.h"

namespace ada {

struct PinsConfig {
  std::optional<std::string> gc, pd; ///< nullopt: not named
  bool gc_active_low = false, pd_active_low = false;
};

struct StoredConfig {
  IioSourceOptions source;
  PinsConfig pins;
  std::string calibration_file; ///< absolute or relative to the caller's folder; empty: none
};

/// Path of the configuration `name`: NAME.toml in $XDG_CONFIG_HOME/ada4571 (~/.config/ada4571),
/// then in /etc/ada4571; a link counts wherever it leads. A name with a slash is a path. Throws
/// NOT_FOUND with the places searched, and INVALID_ARGUMENT for a name that cannot be a file name.
std::string find_config(const std::string &name);

/// Folders that are searched, in this order.
std::vector<std::string> config_folders();

/// Strict: an unknown section or key, a wrong type or a value out of range is refused with file,
/// line and column (ADA4571_ERROR_FORMAT).
StoredConfig parse_config(std::string_view text, const std::string &path);
StoredConfig load_config(const std::string &name);
/// The configuration that save_config(name) would replace.
std::optional<StoredConfig> load_config_if_any(const std::string &name);

/// Names that find_config() knows, in alphabetical order.
std::vector<std::string> config_names();

/// The text of a configuration; parse_config() of it gives the same.
std::string config_text(const StoredConfig &config);

/// Writes NAME.toml into the user's folder (made where needed) or to the path with a slash, whole
/// or not at all. Returns the path.
std::string save_config(const std::string &name, const StoredConfig &config);

} // namespace ada
