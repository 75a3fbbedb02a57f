// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the IIO server shows: devices, channels and attributes, and the frames behind a buffer.
// Plain data; the server knows nothing of sensors, so that the tests serve devices of any kind.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "acquisition/scan_format.h"

namespace ada {

/// Frames in converter counts, one word a scan channel in the order of the scan index, without the
/// timestamp.
class FrameCounts {
public:
  virtual ~FrameCounts() = default;
  /// Fills whole frames and returns how many; fewer than asked for: the stream is at its end.
  virtual std::size_t next(std::span<std::int64_t> counts, std::size_t frames) = 0;
};

/// One attribute file. Reading gives `value` unless `compute` is set.
struct ServedAttribute {
  std::string name;
  std::string value;
  std::function<std::string()> compute{};
  /// 0 or an errno for a value that a client wants to write; unset: read only.
  std::function<int(const std::string &)> accept{};
};

struct ServedChannel {
  std::string id; ///< "voltage0", "timestamp"
  int index = -1; ///< of the scan; negative: no scan element. Scan channels come first.
  ScanFormat format;
  std::optional<double> scale_mv; ///< for the description of the scan element
  std::vector<ServedAttribute> attributes;
};

struct ServedDevice {
  std::string id, name, label;
  std::vector<ServedChannel> channels;
  std::vector<ServedAttribute> attributes;
  double rate_hz = 0.0; ///< pace of the buffer; 0: as fast as it is read. As it is while one is open
  /// A stream for one client's buffer, from the beginning; unset: the device has no buffer.
  std::function<std::unique_ptr<FrameCounts>()> frames{};
  std::string trigger{}; ///< id of the trigger in use
  /// When frame `i` of a stream is taken, seconds after its beginning; unset: by the rate.
  std::function<double(std::uint64_t)> time_s{};
  int open_buffers = 0; ///< of all clients
};

/// A stream that is being played: what is to come, and when its first frame was due.
struct Run {
  std::unique_ptr<FrameCounts> stream;
  std::uint64_t produced = 0; ///< frames of it that were delivered
  std::chrono::steady_clock::time_point began{};
  std::int64_t began_ns = 0; ///< the same for the timestamps
};

/// Runs whose buffers timed out. libiio closes such a buffer, and a client that goes on makes a new
/// one, on a new connection, which says nothing of the old: without these it would get everything
/// from the beginning once more. What tells a client that goes on from a new one is that a new one
/// asks for the context first.
class LeftRuns {
public:
  void leave(const ServedDevice &device, std::string mask, Run run);
  /// That of the same device and channels which has waited longest, if there is one.
  std::optional<Run> take(const ServedDevice &device, std::string_view mask);
  void forget() { left_.clear(); }

private:
  struct Left {
    const ServedDevice *device;
    std::string mask;
    double rate_hz; ///< a run of another rate is another run
    Run run;
  };
  std::vector<Left> left_;
};

struct ServedContext {
  std::string description;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<ServedDevice> devices; ///< triggers too: ids "trigger0"...

  ServedDevice *find_device(std::string_view id);
  LeftRuns left{};
  std::mutex mutex; ///< guards values, rates, triggers and left runs once the server runs
};

/// The context in the XML that libiio 0.24 expects.
std::string context_xml(const ServedContext &context);

} // namespace ada
