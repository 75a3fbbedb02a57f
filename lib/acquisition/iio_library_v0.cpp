// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// libiio 0.x behind iio_library.h; the only file that includes libiio. What 0.24 does against
// expectation, and where it is met:
//  - it has no getter for a channel's label: the attribute "label" is read;
//  - its sample size leaves out the alignment of the frame to its largest element: the layout is
//    computed here (scan_format.h);
//  - a refill that times out loses what it had read: local buffers are switched to non-blocking;
//  - a network server sends every channel that any of its clients has enabled: the layout is
//    checked against the library's after each refill;
//  - it writes into the URI that it is given: it gets a copy;
//  - it trusts the length of what a server sends: buffers of the network are read without it
//    (network_buffer.h);
//  - it waits for ever for a server that goes on sending: each dialogue is watched
//    (server_watch.h), and prints what is wrong with a server's description as it came: that is
//    looked at before (server_description.h).

#include "acquisition/iio_library.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include <iio.h>

#include "acquisition/network_buffer.h"
#include "acquisition/server_description.h"
#include "acquisition/server_watch.h"
#include "base/error.h"
#include "base/no_pipe_signal.h"
#include "base/text.h"

namespace ada {

namespace {

struct ContextDeleter {
  void operator()(iio_context *context) const {
    const NoPipeSignal quiet; // it says goodbye to a server that may be gone
    iio_context_destroy(context);
  }
};
using ContextPointer = std::unique_ptr<iio_context, ContextDeleter>;

/// That a dialogue with a server may take, or the making of a context.
constexpr std::chrono::milliseconds kMostDialogue{60000};

/// Text of a device or a server, fit to be printed.
std::string text(const char *s) {
  return s ? printable(s) : std::string();
}

ScanFormat format_of(const iio_channel *channel) {
  const iio_data_format *f = iio_channel_get_data_format(channel);
  ScanFormat format;
  format.bits = f->bits;
  format.storage = f->length;
  format.shift = f->shift;
  format.repeat = f->repeat ? f->repeat : 1;
  format.is_signed = f->is_signed;
  format.big_endian = f->is_be;
  return format;
}

/// Errors of the connection, not of the attribute.
bool is_connection_lost(ssize_t error) {
  constexpr std::array kLost{EPIPE,    ECONNRESET, ECONNREFUSED, ECONNABORTED,
                             ENOTCONN, ESHUTDOWN,  EBADF,        ETIMEDOUT};
  return std::find(kLost.begin(), kLost.end(), -error) != kLost.end();
}

/// `read(value, size)` of an attribute; nothing where it cannot be read. That the server went away
/// meanwhile says nothing of the attribute: a device without an offset is another one.
template <class Read> std::optional<std::string> read_value(const char *name, Read read) {
  std::array<char, 1024> value{};
  const ssize_t n = read(value.data(), value.size() - 1);
  if (is_connection_lost(n))
    throw Error(ADA4571_ERROR_DISCONNECTED,
                std::string("the connection was lost at the attribute ") + name + ": " +
                    errno_text(static_cast<int>(-n)));
  if (n < 0)
    return std::nullopt;
  // libiio takes the end of the line off where it is the last byte. Of some attributes, as the
  // clock of the timestamps, the kernel hands over a NUL behind it.
  std::string_view said(value.data());
  if (said.ends_with('\n'))
    said.remove_suffix(1);
  return printable(said);
}

std::optional<std::string> read_attribute(const iio_channel *channel, const char *name) {
  if (!iio_channel_find_attr(channel, name))
    return std::nullopt;
  return read_value(name, [&](char *value, std::size_t size) {
    return iio_channel_attr_read(channel, name, value, size);
  });
}

IioChannel describe(const iio_channel *channel) {
  IioChannel out;
  out.id = text(iio_channel_get_id(channel));
  out.name = text(iio_channel_get_name(channel));
  out.label = read_attribute(channel, "label").value_or("");
  const iio_chan_type type = iio_channel_get_type(channel);
  out.is_voltage = type == IIO_VOLTAGE || type == IIO_ALTVOLTAGE;
  out.is_timestamp = type == IIO_TIMESTAMP;
  out.is_output = iio_channel_is_output(channel);
  out.index = iio_channel_is_scan_element(channel) ? iio_channel_get_index(channel) : -1;
  out.format = format_of(channel);
  return out;
}

IioDevice describe(const iio_device *device) {
  IioDevice out{text(iio_device_get_id(device)),
                text(iio_device_get_name(device)),
                text(iio_device_get_label(device)),
                {}};
  for (unsigned i = 0; i < iio_device_get_channels_count(device); ++i)
    out.channels.push_back(describe(iio_device_get_channel(device, i)));
  return out;
}

/// A local buffer, or one behind a server.
class BufferV0 final : public IioBuffer {
public:
  BufferV0(iio_buffer *buffer, std::vector<const iio_channel *> channels)
      : buffer_(buffer), channels_(std::move(channels)), poll_fd_(iio_buffer_get_poll_fd(buffer)) {
    if (poll_fd_ >= 0 && iio_buffer_set_blocking_mode(buffer_, false) < 0)
      poll_fd_ = -1;
    std::vector<ScanFormat> formats;
    for (const iio_channel *channel : channels_)
      formats.push_back(format_of(channel));
    own_ = current_ = compute_layout(formats);
  }
  ~BufferV0() override {
    // A cancelled network buffer is closed without a dialogue with a server that may be dead.
    if (poll_fd_ < 0)
      iio_buffer_cancel(buffer_);
    iio_buffer_destroy(buffer_);
  }
  BufferV0(const BufferV0 &) = delete;
  BufferV0 &operator=(const BufferV0 &) = delete;

  std::ptrdiff_t refill() override { return iio_buffer_refill(buffer_); }
  const std::byte *data() const override {
    return static_cast<const std::byte *>(iio_buffer_start(buffer_));
  }
  int poll_fd() const override { return poll_fd_; }
  void cancel() noexcept override { iio_buffer_cancel(buffer_); }

  /// Local frames hold our channels and nothing else. A server may send more than was asked for
  /// while it serves another client; then the library's offsets tell, and the frame is its step,
  /// completed to the alignment that 0.24 forgets.
  const FrameLayout &layout() override {
    if (poll_fd_ >= 0)
      return own_;
    bool same = true;
    std::size_t largest = 1;
    for (std::size_t i = 0; i < channels_.size(); ++i) {
      const auto *at = static_cast<const std::byte *>(iio_buffer_first(buffer_, channels_[i]));
      current_.offsets[i] = static_cast<std::size_t>(at - data());
      same = same && current_.offsets[i] == own_.offsets[i];
      largest = std::max<std::size_t>(largest, format_of(channels_[i]).element_bytes());
    }
    const auto step =
        static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, iio_buffer_step(buffer_)));
    const std::size_t complete = (step + largest - 1) / largest * largest;
    current_.frame_bytes = complete;
    return same && complete == own_.frame_bytes ? own_ : current_;
  }

private:
  iio_buffer *buffer_;
  std::vector<const iio_channel *> channels_;
  int poll_fd_;
  FrameLayout own_, current_;
};

class ContextV0 final : public IioContext {
public:
  ContextV0(ContextPointer context, std::string port, std::vector<OpenSocket> sockets,
            std::vector<OddFormat> odd_formats)
      : context_(std::move(context)), port_(std::move(port)),
        watch_(port_, std::move(sockets), kMostDialogue), odd_formats_(std::move(odd_formats)) {}

  std::vector<IioDevice> devices() const override {
    const DialogueWatch::Dialogue watched(watch_);
    std::vector<IioDevice> out;
    for (unsigned i = 0; i < iio_context_get_devices_count(context_.get()); ++i) {
      const iio_device *device = iio_context_get_device(context_.get(), i);
      // Debian's libiio lists the hwmon devices in the same context.
      if (text(iio_device_get_id(device)).starts_with("iio:device"))
        out.push_back(describe(device));
    }
    for (const OddFormat &odd : odd_formats_)
      for (IioDevice &device : out)
        for (IioChannel &channel : device.channels)
          if (device.id == odd.device && channel.id == odd.channel)
            channel.odd_format = odd.format;
    return out;
  }
  bool is_local() const override { return text(iio_context_get_name(context_.get())) == "local"; }
  std::string description() const override {
    return text(iio_context_get_description(context_.get()));
  }
  std::string attribute(const std::string &name) const override {
    return text(iio_context_get_attr_value(context_.get(), name.c_str()));
  }
  std::optional<std::string> read(const std::string &device, const std::string &channel,
                                  const std::string &name) const override;
  int write(const std::string &device, const std::string &channel, const std::string &name,
            const std::string &value) override;
  std::string trigger(const std::string &device) const override;
  void set_trigger(const std::string &device, const std::string &trigger) override;
  void set_timeout(std::chrono::milliseconds timeout) override {
    timeout_ = timeout;
    if (!port_.empty())
      return; // that of the buffer, which is not libiio's
    // A server without the command is no reason to fail.
    (void)!iio_context_set_timeout(context_.get(), static_cast<unsigned>(timeout.count()));
  }
  std::unique_ptr<IioBuffer> create_buffer(const std::string &device,
                                           std::span<const std::string> channels,
                                           std::size_t frames, unsigned kernel_buffers,
                                           const Cancellation &cancellation) override;

private:
  iio_device *device(const std::string &id) const {
    iio_device *found = iio_context_find_device(context_.get(), id.c_str());
    if (!found)
      throw Error(ADA4571_ERROR_NOT_FOUND, "no IIO device " + id);
    return found;
  }
  iio_channel *channel(const std::string &device_id, const std::string &id) const {
    iio_channel *found = iio_device_find_channel(device(device_id), id.c_str(), false);
    if (!found)
      throw Error(ADA4571_ERROR_NOT_FOUND, "no channel " + id + " on " + device_id);
    return found;
  }

  std::unique_ptr<IioBuffer> network_buffer(const iio_device *dev,
                                            const std::vector<const iio_channel *> &enabled,
                                            std::size_t frames, unsigned kernel_buffers,
                                            const Cancellation &cancellation, int &error);

  ContextPointer context_;
  std::string port_;            ///< of a server
  mutable DialogueWatch watch_; ///< libiio itself gives up a server that is silent
  std::vector<OddFormat> odd_formats_;
  std::chrono::milliseconds timeout_{5000};
};

std::optional<std::string> ContextV0::read(const std::string &device_id,
                                           const std::string &channel_id,
                                           const std::string &name) const {
  const DialogueWatch::Dialogue watched(watch_);
  if (!channel_id.empty())
    return read_attribute(channel(device_id, channel_id), name.c_str());
  const iio_device *dev = device(device_id);
  if (!iio_device_find_attr(dev, name.c_str()))
    return std::nullopt;
  return read_value(name.c_str(), [&](char *value, std::size_t size) {
    return iio_device_attr_read(dev, name.c_str(), value, size);
  });
}

int ContextV0::write(const std::string &device_id, const std::string &channel_id,
                     const std::string &name, const std::string &value) {
  const DialogueWatch::Dialogue watched(watch_);
  ssize_t n;
  if (!channel_id.empty()) {
    const iio_channel *chn = channel(device_id, channel_id);
    if (!iio_channel_find_attr(chn, name.c_str()))
      return ENOENT; // a plain write would create a file in a test bed
    n = iio_channel_attr_write(chn, name.c_str(), value.c_str());
  } else {
    const iio_device *dev = device(device_id);
    if (!iio_device_find_attr(dev, name.c_str()))
      return ENOENT;
    n = iio_device_attr_write(dev, name.c_str(), value.c_str());
  }
  return n < 0 ? static_cast<int>(-n) : 0;
}

std::string ContextV0::trigger(const std::string &device_id) const {
  const DialogueWatch::Dialogue watched(watch_);
  const iio_device *found = nullptr;
  if (iio_device_get_trigger(device(device_id), &found) < 0 || !found)
    return {};
  return text(iio_device_get_id(found));
}

void ContextV0::set_trigger(const std::string &device_id, const std::string &trigger) {
  const DialogueWatch::Dialogue watched(watch_);
  const iio_device *found = iio_context_find_device(context_.get(), trigger.c_str());
  if (!found || !iio_device_is_trigger(found))
    throw Error(ADA4571_ERROR_NOT_FOUND, "no IIO trigger \"" + trigger + "\"");
  const int error = iio_device_set_trigger(device(device_id), found);
  if (error < 0)
    throw Error(status_of_errno(-error), "cannot use trigger \"" + trigger + "\" for " + device_id +
                                             ": " + errno_text(-error));
}

[[noreturn]] void refuse_buffer(const std::string &device_id, int error) {
  throw Error(status_of_errno(error),
              "cannot start the capture buffer of " + device_id + ": " + errno_text(error) +
                  (error == EINVAL   ? "; most often the device has no trigger: name one with the "
                                       "option for the trigger"
                   : error == ENOMEM ? "; ask for fewer frames a buffer (the emulator holds 320 "
                                       "MiB for all clients together)"
                                     : ""));
}

std::unique_ptr<IioBuffer> ContextV0::create_buffer(const std::string &device_id,
                                                    std::span<const std::string> channels,
                                                    std::size_t frames, unsigned kernel_buffers,
                                                    const Cancellation &cancellation) {
  iio_device *dev = device(device_id);
  std::vector<const iio_channel *> enabled;
  for (unsigned i = 0; i < iio_device_get_channels_count(dev); ++i)
    iio_channel_disable(iio_device_get_channel(dev, i));
  for (const std::string &id : channels) {
    iio_channel *chn = channel(device_id, id);
    iio_channel_enable(chn);
    enabled.push_back(chn);
  }
  if (!port_.empty() && text(iio_context_get_name(context_.get())) == "network") {
    int error = 0;
    auto buffer = network_buffer(dev, enabled, frames, kernel_buffers, cancellation, error);
    if (!buffer)
      refuse_buffer(device_id, error);
    return buffer;
  }
  // Refused by servers that do not know it; the default of 4 holds then.
  (void)!iio_device_set_kernel_buffers_count(dev, kernel_buffers);
  iio_buffer *buffer = iio_device_create_buffer(dev, frames, false);
  if (!buffer)
    refuse_buffer(device_id, errno ? errno : EIO);
  return std::make_unique<BufferV0>(buffer, std::move(enabled));
}

std::unique_ptr<IioBuffer>
ContextV0::network_buffer(const iio_device *dev, const std::vector<const iio_channel *> &enabled,
                          std::size_t frames, unsigned kernel_buffers,
                          const Cancellation &cancellation, int &error) {
  NetworkBufferOptions o;
  o.cancellation = &cancellation;
  o.host = text(iio_context_get_attr_value(context_.get(), "ip,ip-addr"));
  o.port = port_;
  o.device = text(iio_device_get_id(dev));
  o.frames = frames;
  o.kernel_buffers = kernel_buffers;
  o.timeout = timeout_;
  const ssize_t sample_bytes = iio_device_get_sample_size(dev);
  o.bytes = frames * static_cast<std::size_t>(std::max<ssize_t>(1, sample_bytes));
  for (unsigned i = 0; i < iio_device_get_channels_count(dev); ++i) {
    const iio_channel *channel = iio_device_get_channel(dev, i);
    IioChannel place; // and nothing that would have to be asked for
    place.index = iio_channel_is_scan_element(channel) ? iio_channel_get_index(channel) : -1;
    place.format = format_of(channel);
    o.channels.push_back(place);
  }
  for (const iio_channel *channel : enabled)
    for (unsigned i = 0; i < iio_device_get_channels_count(dev); ++i)
      if (iio_device_get_channel(dev, i) == channel)
        o.wanted.push_back(i);
  return open_network_buffer(o, error);
}

[[noreturn]] void refuse_context(const std::string &uri, int error) {
  const std::string where = "IIO context \"" + uri + "\": ";
  if (uri.starts_with("local:") && (error == ENOENT || error == ENODEV))
    throw Error(ADA4571_ERROR_NOT_FOUND,
                where + "this machine has no IIO device (no /sys/bus/iio/devices)");
  if (error == ECONNREFUSED)
    throw Error(ADA4571_ERROR_DISCONNECTED,
                where + "no IIO server answers there; is iiod running?");
  if (uri == "ip:")
    throw Error(ADA4571_ERROR_NOT_FOUND,
                where + "no IIO server was found by Avahi on this network: give ip:HOST");
  if (uri.starts_with("ip:") && (error == ENOENT || error == ENXIO))
    throw Error(ADA4571_ERROR_NOT_FOUND, where + "there is no such host, or no such port");
  if (uri.starts_with("ip:") && error == EINVAL)
    throw Error(ADA4571_ERROR_IO,
                where + "the server's description of its devices cannot be understood");
  if (error == EINVAL || error == ENOSYS)
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                where + "not a URI of libiio; use local:, ip:HOST, ip:HOST:PORT or usb:");
  throw Error(status_of_errno(error), where + errno_text(error));
}

} // namespace

std::unique_ptr<IioContext> open_iio_context(const std::string &uri,
                                             const Cancellation *cancellation) {
  std::vector<OddFormat> odd = check_server_description(uri, cancellation);
  std::string port = server_port(uri);
  const std::vector<OpenSocket> before = sockets_to(port);
  const ServerWatch watch(port, before, ServerWatch::Which::all_but, kMostDialogue, cancellation);
  errno = 0;
  std::string scratch = uri; // 0.24 writes into the text it is given (the colon before the port)
  ContextPointer context(iio_create_context_from_uri(scratch.c_str()));
  const int error = errno;
  if (watch.over()) // it comes as a context all the same, after the last but one question
    throw Error(ADA4571_ERROR_DISCONNECTED,
                "IIO context \"" + uri + "\": the server does not come to an end with its answers");
  if (!context)
    refuse_context(uri, error);
  std::vector<OpenSocket> sockets = sockets_to(port);
  std::erase_if(sockets, [&](const OpenSocket &s) {
    return std::find(before.begin(), before.end(), s) != before.end();
  });
  return std::make_unique<ContextV0>(std::move(context), std::move(port), std::move(sockets),
                                     std::move(odd));
}

std::string iio_library_version() {
  unsigned major = 0, minor = 0;
  char tag[8];
  iio_library_get_version(&major, &minor, tag);
  return std::to_string(major) + "." + std::to_string(minor);
}

ada4571_status status_of_errno(int error) {
  switch (error) {
  case EACCES:
  case EPERM:
    return ADA4571_ERROR_PERMISSION;
  case EBUSY:
    return ADA4571_ERROR_BUSY;
  case ENOENT:
    return ADA4571_ERROR_NOT_FOUND;
  case ENOMEM:
    return ADA4571_ERROR_NO_MEMORY;
  case ENOSYS:
  case EOPNOTSUPP:
    return ADA4571_ERROR_UNSUPPORTED;
  case ENODEV:
  case ENXIO:
  case EPIPE:
  case ECONNRESET:
  case ECONNREFUSED:
  case EHOSTUNREACH:
  case ENETUNREACH:
  case ETIMEDOUT:
    return ADA4571_ERROR_DISCONNECTED;
  default:
    return ADA4571_ERROR_IO;
  }
}

std::string errno_text(int error) {
  std::array<char, 256> buffer{};
  iio_strerror(error, buffer.data(), buffer.size());
  return buffer.data();
}

} // namespace ada
