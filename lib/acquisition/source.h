// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Where frames come from: an IIO device, a recording played back, or the simulated sensor.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "base/frame.h"

namespace ada {

struct SourceInfo {
  std::string description;   ///< "local: ad7380 (iio:device0)", for people
  std::string serial;        ///< empty where unknown
  double sample_rate_hz = 0; ///< 0 where unknown
  double supply_v = 5.0;
  int periods_per_turn = 2;
  bool has_vtemp = false, has_vdd = false, has_reference = false;
  std::optional<bool> gain_control; ///< state of the GC pin where known
  std::optional<int> adc_bits;
  std::size_t buffer_frames = 0; ///< of the next start; 0: the source has no buffer
  int timestamp_clock = -1;      ///< clockid_t of the timestamps; -1: none of this machine's
};

struct SourceStatistics {
  std::uint64_t frames = 0;            ///< delivered since start
  std::uint64_t lost = 0;              ///< missing, counted from the timestamps
  std::uint64_t gaps = 0;              ///< places where frames are missing
  std::int64_t first_timestamp_ns = 0; ///< the device's own, of the frame at time_s = 0
  std::uint64_t bad_times = 0; ///< frames whose timestamp made no sense (sample_clock.h)
};

enum class ReadOutcome {
  frames,    ///< at least one frame was delivered
  timeout,   ///< nothing came in time: an ordinary event, read again
  end,       ///< the source is exhausted (a recording, a bounded simulation)
  cancelled, ///< cancel() was called; start() makes the source usable again
};

struct ReadResult {
  ReadOutcome outcome = ReadOutcome::end;
  std::size_t count = 0;
};

/// One thread reads; cancel() may be called from any other thread. A lost device throws
/// Error(ADA4571_ERROR_DISCONNECTED); start() then tries to open it anew.
class Source {
public:
  virtual ~Source() = default;
  virtual const SourceInfo &info() const = 0;
  virtual void start() = 0;
  virtual ReadResult read(std::span<Frame> out, std::chrono::milliseconds timeout) = 0;
  /// For an event loop, the same at every call: readable while a read that does not wait would tell
  /// something else than a time-out. After a read that did, until one that is a time-out.
  virtual int poll_fd() = 0;
  virtual void cancel() noexcept = 0;
  virtual void stop() noexcept = 0;
  virtual SourceStatistics statistics() const = 0;
};

} // namespace ada
