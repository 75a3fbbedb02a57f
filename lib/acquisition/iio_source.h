// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// An IIO device as a Source: frames in volts with times and losses from the kernel's timestamps.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/channel_choice.h"
#include "acquisition/raw_frames.h"
#include "acquisition/source.h"

namespace ada {

struct IioSourceOptions {
  std::string uri = "local:";
  std::string device; ///< id, label or name; empty: the only one that fits
  ChannelSelection channels;
  std::string trigger;           ///< empty: leave what is set
  double sample_rate_hz = 0.0;   ///< 0: leave what is set
  double supply_v = 5.0;         ///< (0, 50]
  int periods_per_turn = 2;      ///< 1 to 65536
  std::size_t buffer_frames = 0; ///< 0: as many as latency_s allows
  double latency_s = 0.0; ///< longest wait of a frame for its buffer; 0: a twentieth of a second
};

/// The driver's own calibration of the pair, as in sysfs: calibbias in counts (added to the
/// reading), calibscale as a factor (of the reading).
struct DriverCalibration {
  struct Channel {
    std::optional<double> bias, scale; ///< nullopt: the driver has no such attribute
    double volts_per_count = 0.0;
  };
  Channel sin, cos;
};

class IioSource : public Source {
public:
  /// Length of the buffers from the next start on; 0: by the options.
  virtual void set_buffer_frames(std::size_t frames) = 0;
  /// NOT_FOUND where a channel has neither attribute.
  virtual DriverCalibration read_driver_calibration() = 0;
  /// Writes the values that are there; all or nothing as far as the kernel allows: a refusal puts
  /// back what was written before it and throws with the kernel's reason.
  virtual void write_driver_calibration(const DriverCalibration &calibration) = 0;
  /// How the device's own integers lie in its frames, where a recording can keep them: they have
  /// timestamps, and no value is beyond what a capture may hold.
  virtual const std::optional<RawForm> &raw_form() const = 0;
  /// As read(), without a sample converted; UNSUPPORTED where there is no raw_form().
  virtual ReadOutcome read_raw(std::size_t most, std::chrono::milliseconds timeout,
                               RawFrames &out) = 0;
  /// What was asked for, with device and channels as found, for a stored configuration.
  virtual IioSourceOptions resolved_options() const = 0;
};

/// Finds device and channels, sets trigger and rate. Throws Error with a sentence.
std::unique_ptr<IioSource> open_iio_source(const IioSourceOptions &options);

struct IioListEntry {
  IioDevice device;
  std::string channels;            ///< list_channels()
  std::string sin, cos, temp, vdd; ///< ids by label, empty when unknown
  bool labelled = false;
};

/// Devices with two voltage inputs that can be captured. A machine without IIO gives none.
std::vector<IioListEntry> list_iio_devices(const std::string &uri);

} // namespace ada
