// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Which channels of an IIO device carry the sensor: by option (id, name or label), else by the
// labels vsin, vcos, vtemp and vdd of the device tree. Pure functions on descriptions.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/iio_library.h"

namespace ada {

/// What the caller asked for; an empty entry is searched by label.
struct ChannelSelection {
  std::string sin, cos, temp, vdd;
};

/// Positions in IioDevice::channels.
struct ChannelChoice {
  std::size_t sin = 0, cos = 0;
  std::optional<std::size_t> temp, vdd, timestamp;
};

/// Throws NOT_FOUND, UNSUPPORTED (cannot be captured, or is no voltage) or INVALID_ARGUMENT (two
/// roles, one channel), each with a sentence that lists what the device has.
ChannelChoice choose_channels(const IioDevice &device, const ChannelSelection &selection);

/// Whether the labels vsin and vcos are there, so that no option is needed.
bool labels_name_pair(const IioDevice &device);

/// Whether two voltage inputs can be captured together.
bool has_usable_pair(const IioDevice &device);

/// The device called `name` (id, label or name); with an empty name the only one that can serve
/// `selection`. Throws NOT_FOUND, or INVALID_ARGUMENT when several fit.
const IioDevice &choose_device(std::span<const IioDevice> devices, const std::string &name,
                               const ChannelSelection &selection);

/// "voltage0 (vsin), voltage1 (vcos)": inputs that can be captured.
std::string list_channels(const IioDevice &device);

/// Name for people: "ad7380 (iio:device0)".
std::string display_name(const IioDevice &device);

} // namespace ada
