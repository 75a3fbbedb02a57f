// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What the IIO server shows: devices, channels and attributes, and the frames behind a buffer.
// Plain data; the server knows nothing of sensors, so that the tests serve devices of any kind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
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

struct ServedContext {
  std::string description;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<ServedDevice> devices; ///< triggers too: ids "trigger0"...

  ServedDevice *find_device(std::string_view id);
  std::mutex mutex; ///< guards values, rates and triggers once the server runs
};

/// The context in the XML that libiio 0.24 expects.
std::string context_xml(const ServedContext &context);

} // namespace ada
