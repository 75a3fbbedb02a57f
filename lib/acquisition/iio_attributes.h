// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The numbers of an IIO device that stand in attributes: scale and offset, sampling frequency,
// driver calibration. Every value is checked; a wrong one is named with device, channel and text.
#pragma once

#include <string>

#include "acquisition/iio_library.h"
#include "acquisition/iio_source.h"

namespace ada {

/// scale (mV a count, required) and offset (counts, 0 where there is none) of a voltage channel.
LinearScale read_scale(const IioContext &context, const IioDevice &device,
                       const IioChannel &channel);

/// sampling_frequency of the trigger in use, of the device, or of the channel; 0 where unknown.
double read_sample_rate(const IioContext &context, const IioDevice &device,
                        const IioChannel &channel);

/// Sets it at the first of the same places that has it and returns what the driver made of it. A
/// device that has it nowhere keeps its own rate, and the caller's word is taken for it.
double write_sample_rate(IioContext &context, const IioDevice &device, const IioChannel &channel,
                         double rate_hz);

DriverCalibration::Channel read_driver_calibration(const IioContext &context,
                                                   const IioDevice &device,
                                                   const IioChannel &channel);

void write_driver_calibration(IioContext &context, const IioDevice &device, const IioChannel &sin,
                              const IioChannel &cos, const DriverCalibration &calibration);

/// Whether a program here reads the same clocks as what is behind the URI.
bool is_this_machine(const IioContext &context, const std::string &uri);
/// clockid_t of the device's timestamps, -1 for one that this file does not know.
int read_timestamp_clock(const IioContext &context, const IioDevice &device);

/// What to do about a refused permission.
std::string permission_hint(const std::string &uri);

} // namespace ada
