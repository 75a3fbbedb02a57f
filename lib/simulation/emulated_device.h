// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A sensor behind a converter as a served IIO device, with the attributes that a driver gives it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "acquisition/source.h"
#include "simulation/served_context.h"

namespace ada {

/// One channel of the converter: volts at the sensor = volts_per_count * counts.
struct EmulatedChannel {
  const char *label;
  double Frame::*member;
  ScanFormat format;
  double volts_per_count;
};

struct EmulatedSensor {
  std::string description, device, serial;
  std::vector<EmulatedChannel> channels;
  double rate_hz;             ///< to begin with
  std::vector<double> rates;  ///< those that can be set, ascending, rate_hz among them
  /// Its frames from the beginning at that rate, as fast as they are read.
  std::function<std::unique_ptr<Source>(double rate_hz)> play;
  double speed = 1.0; ///< seconds of the frames' times in a second of the device's
  /// As ServedDevice::time_s.
  std::function<double(std::uint64_t)> time_s{};
};

/// voltage0... as the channels are, timestamp, sampling_frequency, which is settable to one of
/// sampling_frequency_available while no buffer is open, and a trigger of the same rate. Each
/// buffer begins anew, but for one that takes the place of one that timed out. `raw` is what the
/// converter gives at the moment of the reading.
std::shared_ptr<ServedContext> emulated_context(EmulatedSensor sensor);

} // namespace ada
