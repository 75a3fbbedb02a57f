// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What this project needs of libiio, without a type of libiio: the one file iio_library_v0.cpp
// implements it for libiio 0.x, and a file for 1.x would implement the same.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "acquisition/scan_format.h"
#include "base/error.h"
#include "base/untouched.h"

namespace ada {

class Cancellation;

struct IioChannel {
  std::string id;    ///< "voltage0"
  std::string name;  ///< the driver's own name of it, often empty
  std::string label; ///< from the device tree, often empty
  bool is_voltage = false;
  bool is_timestamp = false;
  bool is_output = false;
  long index = -1;          ///< position in the scan, negative: cannot be captured
  ScanFormat format;        ///< of a channel that can
  std::string odd_format{}; ///< as its server has it, where `format` is something else
};

struct IioDevice {
  std::string id;    ///< "iio:device0"
  std::string name;  ///< "ad7380"
  std::string label; ///< from the device tree, often empty
  std::vector<IioChannel> channels;
};

/// A running capture buffer. refill(), data() and layout() belong to one thread; cancel() may come
/// from any.
class IioBuffer {
public:
  virtual ~IioBuffer() = default;
  /// Bytes that have arrived (at data()), or a negative errno. On a buffer with a poll fd it does
  /// not wait (-EAGAIN), on others it waits for a whole buffer.
  virtual std::ptrdiff_t refill() = 0;
  virtual const std::byte *data() const = 0;
  /// Gives what is at data() away against another piece of memory, without a copy; false where a
  /// buffer cannot.
  virtual bool exchange(UntouchedBytes &) { return false; }
  /// Fd to poll for input; negative where the backend has none (network, USB).
  virtual int poll_fd() const = 0;
  /// Layout of the frames of the last refill: one offset a channel as given to create_buffer.
  virtual const FrameLayout &layout() = 0;
  /// Ends a waiting refill() with -EBADF; the buffer is then good for nothing but deletion.
  virtual void cancel() noexcept = 0;
};

/// A set of devices behind one URI. Attribute functions throw Error with the kernel's reason.
class IioContext {
public:
  virtual ~IioContext() = default;

  virtual std::vector<IioDevice> devices() const = 0;
  virtual bool is_local() const = 0;
  virtual std::string description() const = 0;
  /// Attribute of the context ("hw_serial"), empty where there is none.
  virtual std::string attribute(const std::string &name) const = 0;

  /// Attribute of a device, or of its channel where `channel` is not empty; nullopt where the
  /// attribute does not exist.
  virtual std::optional<std::string> read(const std::string &device, const std::string &channel,
                                          const std::string &name) const = 0;
  /// Returns 0 or a positive errno, for a message of the caller's.
  virtual int write(const std::string &device, const std::string &channel, const std::string &name,
                    const std::string &value) = 0;

  /// Id of the trigger in use, empty when none.
  virtual std::string trigger(const std::string &device) const = 0;
  /// `trigger` by id or name. Throws with the kernel's reason.
  virtual void set_trigger(const std::string &device, const std::string &trigger) = 0;

  virtual void set_timeout(std::chrono::milliseconds timeout) = 0;

  /// Enables exactly these channels (ids) and starts the capture. Throws with the kernel's reason,
  /// and at once when a server is waited for while `cancellation` is raised.
  virtual std::unique_ptr<IioBuffer> create_buffer(const std::string &device,
                                                   std::span<const std::string> channels,
                                                   std::size_t frames, unsigned kernel_buffers,
                                                   const Cancellation &cancellation) = 0;
};

/// `uri` as libiio takes it. Throws NOT_FOUND, PERMISSION, DISCONNECTED (server does not answer) or
/// IO, each with a sentence that names the URI. A server that does not answer is waited for no
/// longer than `cancellation`, where there is one, is low.
std::unique_ptr<IioContext> open_iio_context(const std::string &uri,
                                             const Cancellation *cancellation = nullptr);

/// Version of the libiio that is linked, "0.24".
std::string iio_library_version();

/// The status that fits an errno, and the system's sentence for it.
ada4571_status status_of_errno(int error);
std::string errno_text(int error);

} // namespace ada
