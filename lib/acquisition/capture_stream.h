// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Blocks of raw bytes from a capture buffer, with a deadline and a cancel that works at once. Two
// ways, because libiio 0.24 treats its backends differently: a local buffer is polled, a network
// buffer has no fd to poll and is read by a thread of its own. In neither does the reading thread
// allocate, or wait for a lock that another thread may hold.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "acquisition/iio_library.h"
#include "acquisition/readiness.h"
#include "acquisition/wake_up.h"

namespace ada {

struct CaptureBlock {
  std::span<const std::byte> bytes;
  const FrameLayout *layout = nullptr;
};

class CaptureStream {
public:
  using Clock = std::chrono::steady_clock;
  enum class Event { data, timeout, end, cancelled };

  virtual ~CaptureStream() = default;
  /// Waits for the next block until the deadline; a deadline in the past looks once. `cancelled`
  /// while the cancellation is up. `end`: a server that plays a recording has come to its end. The
  /// block lives until the next call. Throws DISCONNECTED when device or server are gone, IO
  /// otherwise.
  virtual Event next(CaptureBlock &block, Clock::time_point deadline) = 0;
  /// Has the descriptors watched that are readable when next() may have something. One may be so for
  /// nothing; a next() that is a time-out makes it quiet.
  virtual void announce_to(Readiness &readiness) = 0;
};

/// For buffers with a poll fd. `presence_path` is a path that exists as long as the device does: on
/// removal the kernel wakes no poll. `name` is for messages. The cancellation outlives the stream.
std::unique_ptr<CaptureStream> make_polled_stream(const Cancellation &cancellation,
                                                  std::unique_ptr<IioBuffer> buffer,
                                                  std::string presence_path, std::string name);

/// Makes a buffer of that many frames whose refill gives up after the timeout; fails at once when the
/// cancellation is raised meanwhile.
using BufferFactory = std::function<std::unique_ptr<IioBuffer>(
    std::size_t frames, std::chrono::milliseconds, const Cancellation &)>;

/// For buffers that can only block. After a time-out, which makes the buffer of 0.24 useless, a new
/// one is made: smaller, with a longer time-out; where that fails the server is gone. `block_bytes`
/// is the expected size of a block, `blocks` how many are held for a reader that is late.
std::unique_ptr<CaptureStream> make_threaded_stream(const Cancellation &cancellation,
                                                    BufferFactory factory, std::size_t frames,
                                                    std::chrono::milliseconds timeout,
                                                    std::size_t block_bytes, std::size_t blocks,
                                                    std::string name);

} // namespace ada
