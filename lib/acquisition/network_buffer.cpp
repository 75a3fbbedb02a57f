// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/network_buffer.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include "acquisition/wake_up.h"
#include "base/descriptor.h"

namespace ada {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kLongestNumber = 24;
constexpr unsigned kMaskBits = 32, kMaskDigits = 8;

/// What ends a command; caught where the command was given.
struct Failed {
  int error;
};

/// A connection: what does not come within the time-out fails with ETIMEDOUT, and after cancel()
/// everything with EBADF. Neither allocates nor locks once it is connected.
class Connection {
public:
  Connection(const std::string &host, const std::string &port, std::chrono::milliseconds timeout)
      : timeout_(timeout) {
    addrinfo hints{}, *found = nullptr;
    hints.ai_socktype = SOCK_STREAM;
    hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
    if (getaddrinfo(host.c_str(), port.c_str(), &hints, &found) != 0)
      throw Failed{EHOSTUNREACH};
    const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> address(found, freeaddrinfo);
    socket_ = Descriptor(
        ::socket(address->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, IPPROTO_TCP));
    if (socket_.get() < 0)
      throw Failed{errno};
    const int on = 1; // a command is short and waits for nothing
    (void)::setsockopt(socket_.get(), IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    if (::connect(socket_.get(), address->ai_addr, address->ai_addrlen) == 0)
      return;
    if (errno != EINPROGRESS)
      throw Failed{errno};
    wait(POLLOUT);
    int error = 0;
    socklen_t size = sizeof error;
    if (::getsockopt(socket_.get(), SOL_SOCKET, SO_ERROR, &error, &size) != 0 || error != 0)
      throw Failed{error ? error : errno};
  }

  void cancel() noexcept { cancelled_.raise(); }

  void send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (n > 0)
        bytes.remove_prefix(static_cast<std::size_t>(n));
      else if (errno == EAGAIN)
        wait(POLLOUT);
      else if (errno != EINTR)
        throw Failed{errno};
    }
  }

  void receive(std::byte *out, std::size_t count) {
    const std::size_t held = std::min(count, end_ - begin_);
    std::memcpy(out, held_.data() + begin_, held);
    begin_ += held;
    for (std::size_t have = held; have < count;)
      have += receive_some(out + have, count - have);
  }

  /// A line that is a number; empty ones before it do not count.
  long number() {
    std::array<char, kLongestNumber> line;
    for (std::size_t n = 0; n < line.size();) {
      const char c = next_byte();
      if (c != '\n') {
        line[n++] = c;
      } else if (n > 0 && !(n == 1 && line[0] == '\r')) {
        const char *end = line.data() + n - (line[n - 1] == '\r');
        long value = 0;
        const auto [rest, error] = std::from_chars(line.data(), end, value);
        if (error != std::errc{} || rest != end)
          break;
        return value;
      } else {
        n = 0;
      }
    }
    throw Failed{EBADMSG};
  }

private:
  void wait(short events) {
    pollfd fds[2] = {{cancelled_.fd(), POLLIN, 0}, {socket_.get(), events, 0}};
    const auto deadline = Clock::now() + timeout_;
    int ready = 0;
    do
      ready = ::poll(fds, 2, poll_timeout(deadline));
    while (ready < 0 && errno == EINTR);
    if (ready < 0 || fds[0].revents != 0)
      throw Failed{ready < 0 ? errno : EBADF};
    if (ready == 0)
      throw Failed{ETIMEDOUT};
  }

  std::size_t receive_some(std::byte *out, std::size_t count) {
    for (;;) {
      if (cancelled_.raised())
        throw Failed{EBADF};
      const ssize_t n = ::recv(socket_.get(), out, count, 0);
      if (n > 0)
        return static_cast<std::size_t>(n);
      if (n == 0)
        throw Failed{EPIPE};
      if (errno == EAGAIN)
        wait(POLLIN);
      else if (errno != EINTR)
        throw Failed{errno};
    }
  }

  char next_byte() {
    if (begin_ == end_) {
      begin_ = 0;
      end_ = 0;
      end_ = receive_some(held_.data(), held_.size());
    }
    return static_cast<char>(held_[begin_++]);
  }

  std::chrono::milliseconds timeout_;
  Descriptor socket_;
  Cancellation cancelled_;
  std::array<std::byte, 512> held_; ///< came together with a line
  std::size_t begin_ = 0, end_ = 0;
};

class NetworkBuffer final : public IioBuffer {
public:
  explicit NetworkBuffer(const NetworkBufferOptions &o)
      : wanted_(o.wanted), connection_(o.host, o.port, o.timeout), bytes_(o.bytes),
        mask_((o.channels.size() + kMaskBits - 1) / kMaskBits), seen_(mask_.size()),
        mask_text_(mask_.size() * kMaskDigits + 1),
        read_command_(fmt::format("READBUF {} {}\r\n", o.device, o.bytes)) {
    for (const IioChannel &channel : o.channels) {
      formats_.push_back(channel.format);
      indices_.push_back(channel.index);
    }
    for (const std::size_t i : wanted_)
      mask_[i / kMaskBits] |= 1u << i % kMaskBits;
    // The server is to give up first, and say so. One without the command is no reason to fail.
    connection_.send(fmt::format("TIMEOUT {}\r\n", o.timeout.count() / 2));
    connection_.number();
    std::string words;
    for (auto word = mask_.rbegin(); word != mask_.rend(); ++word)
      words += fmt::format("{:08x}", *word);
    connection_.send(fmt::format("OPEN {} {} {}\r\n", o.device, o.frames, words));
    if (const long answer = connection_.number(); answer < 0)
      throw Failed{static_cast<int>(std::min<long>(-answer, 4095))};
    lay_out(mask_);
  }

  std::ptrdiff_t refill() override {
    try {
      connection_.send(read_command_);
      std::size_t have = 0;
      for (bool first = true; have < bytes_.size(); first = false) {
        const long count = connection_.number();
        if (count < 0)
          return std::max<long>(count, -4095);
        if (count == 0)
          break;
        if (first)
          read_mask();
        if (static_cast<unsigned long>(count) > bytes_.size() - have)
          throw Error(ADA4571_ERROR_IO,
                      fmt::format("the server sends {} bytes where {} were asked for: do not trust "
                                  "it",
                                  count, bytes_.size() - have));
        connection_.receive(bytes_.data() + have, static_cast<std::size_t>(count));
        have += static_cast<std::size_t>(count);
      }
      return static_cast<std::ptrdiff_t>(have);
    } catch (const Failed &failed) {
      return -failed.error;
    }
  }

  const std::byte *data() const override { return bytes_.data(); }
  int poll_fd() const override { return -1; }
  void cancel() noexcept override { connection_.cancel(); }
  const FrameLayout &layout() override { return layout_; }

private:
  /// Hexadecimal words, the highest first. The server sends every channel that any client wants.
  void read_mask() {
    connection_.receive(mask_text_.data(), mask_text_.size());
    const auto *text = reinterpret_cast<const char *>(mask_text_.data());
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const char *word = text + (seen_.size() - 1 - i) * kMaskDigits;
      const auto [end, error] = std::from_chars(word, word + kMaskDigits, seen_[i], 16);
      if (error != std::errc{} || end != word + kMaskDigits || (seen_[i] & mask_[i]) != mask_[i])
        throw Failed{EBADMSG};
    }
    if (seen_ != laid_out_)
      lay_out(seen_);
  }

  /// Where our channels lie in a frame of these. Channels of one index share their place.
  void lay_out(const std::vector<unsigned> &mask) {
    std::vector<ScanFormat> elements;
    std::vector<std::size_t> element_of(formats_.size());
    long last = -1;
    for (std::size_t i = 0; i < formats_.size(); ++i) {
      if (!(mask[i / kMaskBits] >> i % kMaskBits & 1u) || indices_[i] < 0)
        continue;
      if (elements.empty() || indices_[i] != last)
        elements.push_back(formats_[i]);
      element_of[i] = elements.size() - 1;
      last = indices_[i];
    }
    const FrameLayout all = compute_layout(elements);
    layout_.offsets.clear();
    for (const std::size_t i : wanted_)
      layout_.offsets.push_back(all.offsets[element_of[i]]);
    layout_.frame_bytes = all.frame_bytes;
    laid_out_ = mask;
  }

  std::vector<std::size_t> wanted_;
  std::vector<ScanFormat> formats_;
  std::vector<long> indices_;
  Connection connection_;
  std::vector<std::byte> bytes_;
  std::vector<unsigned> mask_, seen_, laid_out_; ///< what was asked for, came last, layout_ is of
  std::vector<std::byte> mask_text_;
  std::string read_command_;
  FrameLayout layout_;
};

} // namespace

std::unique_ptr<IioBuffer> open_network_buffer(const NetworkBufferOptions &options, int &error) {
  try {
    return std::make_unique<NetworkBuffer>(options);
  } catch (const Failed &failed) {
    error = failed.error;
    return nullptr;
  }
}

} // namespace ada
