// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Captures to write and read back.
#pragma once

#include <cmath>
#include <random>
#include <string>

#include "base/error.h"
#include "recording/capture.h"
#include "recording/capture_file.h"
#include "recording/columns.h"

namespace ada::test {

/// What a failing call says, "" when it does not fail; `status` gets its status.
template <class Call> std::string failure(Call call, ada4571_status *status = nullptr) {
  try {
    call();
  } catch (const Error &e) {
    if (status)
      *status = e.status();
    return e.what();
  }
  return {};
}

/// Samples that a converter of `bits` bits with a reference of `reference_v` gives, every channel
/// present, at `rate_hz` on a regular clock. Codes are drawn over the whole range.
inline Capture counted_capture(std::mt19937_64 &rng, std::size_t size, int bits, double reference_v,
                               double rate_hz) {
  Capture capture;
  capture.meta.adc_bits = bits;
  capture.meta.adc_reference_v = reference_v;
  capture.meta.sample_rate_hz = rate_hz;
  std::uniform_int_distribution<std::int64_t> code(0, (std::int64_t{1} << bits) - 1);
  std::uniform_real_distribution<double> degrees(0, 360), supply(4.9, 5.1);
  const double step = reference_v / std::exp2(bits);
  for (std::size_t i = 0; i < size; ++i) {
    capture.time_s.push_back(static_cast<double>(i) / rate_hz);
    capture.vsin_v.push_back(static_cast<double>(code(rng)) * step);
    capture.vcos_v.push_back(static_cast<double>(code(rng)) * step);
    capture.vtemp_v.push_back(static_cast<double>(code(rng)) * step);
    capture.vdd_v.push_back(supply(rng));
    capture.reference_deg.push_back(degrees(rng));
  }
  return capture;
}

/// Without the channels that are no codes of the converter.
inline Capture converter_channels_only(Capture capture) {
  capture.vdd_v.clear();
  capture.reference_deg.clear();
  return capture;
}

} // namespace ada::test
