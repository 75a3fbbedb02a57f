// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// One connection: lines in, answers out. The commands and their answers are those of iiod 0.24.

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <vector>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/timespec.h"
#include "simulation/iiod_buffer.h"
#include "simulation/iiod_server.h"

namespace ada {

namespace {

constexpr std::size_t kLongestLine = 4096;
constexpr std::size_t kLongestValue = 4096;
constexpr std::chrono::milliseconds kDefaultTimeout{2500};

using Words = std::vector<std::string_view>;

Words split(std::string_view line) {
  Words words;
  while (!line.empty()) {
    const std::size_t end = std::min(line.find(' '), line.size());
    words.push_back(line.substr(0, end)); // an empty last word means "all attributes"
    if (end == line.size())
      break;
    line.remove_prefix(end + 1);
    if (line.empty())
      words.push_back({});
  }
  return words;
}

template <class Number> std::optional<Number> parse(std::string_view text, int base = 10) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  if (error != std::errc{} || end != text.data() + text.size())
    return std::nullopt;
  return value;
}

/// The end of a connection, for whatever reason.
struct Closed {};

/// A device's buffer in the hands of a client: as long as there is one, the rate stays.
class OpenBuffer {
public:
  OpenBuffer(ServedContext &context, ServedDevice &device)
      : buffer(device), context_(context), device_(device) {
    const std::lock_guard lock(context_.mutex);
    ++device_.open_buffers;
  }
  ~OpenBuffer() {
    const std::lock_guard lock(context_.mutex);
    --device_.open_buffers;
  }
  OpenBuffer(const OpenBuffer &) = delete;
  OpenBuffer &operator=(const OpenBuffer &) = delete;

  bool of(const ServedDevice &device) const { return &device == &device_; }
  const ServedDevice &device() const { return device_; }

  IiodBuffer buffer;

private:
  ServedContext &context_;
  ServedDevice &device_;
};

class Connection {
public:
  Connection(int fd, int stop_fd, ServedContext &context, const IiodServer::FaultHook &faults)
      : fd_(fd), stop_fd_(stop_fd), context_(context), faults_(faults) {}

  void serve() {
    try {
      while (execute(read_line()))
        ;
    } catch (const Closed &) {
    }
  }

private:
  // --- bytes

  void fill() {
    pollfd fds[2] = {{stop_fd_, POLLIN, 0}, {fd_, POLLIN, 0}};
    while (poll(fds, 2, -1) < 0)
      if (errno != EINTR)
        throw Closed{};
    if (fds[0].revents)
      throw Closed{};
    char bytes[4096];
    const ssize_t n = recv(fd_, bytes, sizeof bytes, 0);
    if (n <= 0)
      throw Closed{};
    input_.append(bytes, static_cast<std::size_t>(n));
  }

  std::string read_line() {
    for (;;) {
      const std::size_t end = input_.find('\n');
      if (end != std::string::npos) {
        std::string line = input_.substr(0, end);
        input_.erase(0, end + 1);
        while (!line.empty() && line.back() == '\r')
          line.pop_back();
        return line;
      }
      if (input_.size() > kLongestLine)
        throw Closed{};
      fill();
    }
  }

  std::string read_bytes(std::size_t count) {
    while (input_.size() < count)
      fill();
    std::string bytes = input_.substr(0, count);
    input_.erase(0, count);
    return bytes;
  }

  void send_all(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (n < 0 && errno == EINTR)
        continue;
      if (n <= 0)
        throw Closed{};
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
  }

  void answer(long value) { send_all(std::to_string(value) + "\n"); }
  void answer_text(std::string_view text) {
    send_all(std::to_string(text.size()) + "\n" + std::string(text) + "\n");
  }

  /// Waits; true when the time is over, else the client or the server is gone.
  void wait_until(IiodBuffer::Clock::time_point due) {
    for (;;) {
      const auto left = due - IiodBuffer::Clock::now();
      if (left <= left.zero())
        return;
      const timespec wait = timespec_of(std::chrono::duration_cast<std::chrono::nanoseconds>(left));
      pollfd fds[2] = {{stop_fd_, POLLIN, 0}, {fd_, POLLRDHUP, 0}};
      if (ppoll(fds, 2, &wait, nullptr) > 0)
        throw Closed{};
    }
  }

  // --- commands

  bool execute(const std::string &line) {
    if (line.empty())
      return true;
    if (faults_ && !apply_fault(faults_(line), line))
      return true;
    const Words words = split(line);
    const std::string_view verb = words[0];
    if (verb == "EXIT")
      return false;
    if (verb == "PRINT")
      print();
    else if (verb == "VERSION")
      send_all("0.24.v0.24  \n");
    else if (verb == "TIMEOUT")
      timeout(words);
    else if (verb == "READ")
      read_attribute(words);
    else if (verb == "WRITE")
      write_attribute(words);
    else if (verb == "GETTRIG" || verb == "SETTRIG")
      trigger(words);
    else if (verb == "SET")
      answer(words.size() == 4 && words[2] == "BUFFERS_COUNT" ? 0 : -EINVAL);
    else if (verb == "OPEN" || verb == "CLOSE" || verb == "READBUF")
      buffer_command(words);
    else
      answer(-EINVAL);
    return true;
  }

  /// False when the command has had its answer.
  bool apply_fault(const IiodFault &fault, const std::string &line) {
    switch (fault.kind) {
    case IiodFault::Kind::none:
      return true;
    case IiodFault::Kind::error:
      if (line.starts_with("WRITE")) // the value follows all the same
        read_bytes(parse<std::size_t>(split(line).back()).value_or(0));
      answer(-fault.value);
      return false;
    case IiodFault::Kind::stall:
      wait_until(IiodBuffer::Clock::now() + std::chrono::hours(1));
      throw Closed{};
    case IiodFault::Kind::drop:
      throw Closed{};
    case IiodFault::Kind::short_answer:
      if (buffer_ && line.starts_with("READBUF")) {
        const std::size_t bytes = parse<std::size_t>(split(line).back()).value_or(0);
        send_all(std::to_string(bytes) + "\n" + buffer_->buffer.mask_text() + "\n" +
                 std::string(bytes / 2, '\0'));
      } else {
        send_all("1000\nhalf");
      }
      throw Closed{};
    case IiodFault::Kind::raw_answer:
      send_all(fault.text);
      return false;
    }
    return true;
  }

  void print() {
    {
      const std::lock_guard lock(context_.mutex);
      context_.left.forget();
    }
    answer_text(context_xml(context_));
  }

  void timeout(const Words &words) {
    const auto ms = words.size() == 2 ? parse<unsigned>(words[1]) : std::nullopt;
    if (ms)
      timeout_ = std::chrono::milliseconds(*ms);
    answer(ms ? 0 : -EINVAL);
  }

  /// Attributes that `READ dev ...` or `WRITE dev ...` means, and the position of their name.
  std::vector<ServedAttribute> *find_attributes(const Words &words, std::size_t &name_at) {
    ServedDevice *device = words.size() >= 3 ? context_.find_device(words[1]) : nullptr;
    if (!device)
      return nullptr;
    if (words[2] == "INPUT" || words[2] == "OUTPUT") {
      name_at = 4;
      if (words.size() < 5 || words[2] == "OUTPUT")
        return nullptr;
      for (ServedChannel &channel : device->channels)
        if (channel.id == words[3])
          return &channel.attributes;
      return nullptr;
    }
    if (words[2] == "DEBUG" || words[2] == "BUFFER") {
      static thread_local std::vector<ServedAttribute> none;
      name_at = 3;
      return words.size() < 4 ? nullptr : &none;
    }
    name_at = 2;
    return &device->attributes;
  }

  static std::string value_of(const ServedAttribute &attribute) {
    return (attribute.compute ? attribute.compute() : attribute.value) + '\0';
  }

  void read_attribute(const Words &words) {
    std::unique_lock lock(context_.mutex);
    std::size_t name_at = 0;
    const auto *attributes = find_attributes(words, name_at);
    if (!attributes) {
      lock.unlock();
      return answer(-ENODEV);
    }
    std::string text;
    bool found = false;
    for (const ServedAttribute &attribute : *attributes) {
      if (words[name_at].empty()) {
        append_block(text, value_of(attribute));
      } else if (attribute.name == words[name_at]) {
        text = value_of(attribute);
        found = true;
      }
    }
    lock.unlock();
    if (!words[name_at].empty() && !found)
      return answer(-ENOENT);
    answer_text(text);
  }

  /// One of all attributes: length as 32 bits, big endian, then the value padded to 4 bytes.
  static void append_block(std::string &text, const std::string &value) {
    for (int shift = 24; shift >= 0; shift -= 8)
      text += static_cast<char>((value.size() >> shift) & 0xff);
    text += value;
    text.append((4 - value.size() % 4) % 4, '\0');
  }

  void write_attribute(const Words &words) {
    const auto length = parse<std::size_t>(words.back());
    if (!length || *length > kLongestValue) {
      answer(-EINVAL);
      throw Closed{}; // where the value ends is unknown
    }
    std::string value = read_bytes(*length);
    value = value.substr(0, value.find('\0'));
    while (!value.empty() && value.back() == '\n')
      value.pop_back();

    Words target(words.begin(), words.end() - 1);
    std::unique_lock lock(context_.mutex);
    std::size_t name_at = 0;
    auto *attributes = find_attributes(target, name_at);
    int error = attributes ? ENOENT : ENODEV;
    if (attributes)
      for (ServedAttribute &attribute : *attributes)
        if (attribute.name == target[name_at]) {
          error = attribute.accept ? attribute.accept(value) : EACCES;
          if (error == 0)
            attribute.value = value;
        }
    lock.unlock();
    answer(error ? -error : static_cast<long>(*length));
  }

  void trigger(const Words &words) {
    std::unique_lock lock(context_.mutex);
    ServedDevice *device = words.size() >= 2 ? context_.find_device(words[1]) : nullptr;
    if (!device) {
      lock.unlock();
      return answer(-ENODEV);
    }
    if (words[0] == "SETTRIG") {
      const std::string wanted(words.size() >= 3 ? words[2] : "");
      const bool known =
          wanted.empty() || (wanted.starts_with("trigger") && context_.find_device(wanted));
      if (known)
        device->trigger = wanted;
      lock.unlock();
      return answer(known ? 0 : -ENXIO);
    }
    const ServedDevice *used =
        device->trigger.empty() ? nullptr : context_.find_device(device->trigger);
    const std::string name = used ? used->name : "";
    lock.unlock();
    return used ? answer_text(name) : answer(0);
  }

  void buffer_command(const Words &words) {
    ServedDevice *device = words.size() >= 2 ? context_.find_device(words[1]) : nullptr;
    if (!device)
      return answer(-ENODEV);
    if (words[0] == "OPEN")
      return open(*device, words);
    if (!buffer_ || !buffer_->of(*device))
      return answer(-EBADF);
    if (words[0] == "CLOSE") {
      buffer_.reset();
      return answer(0);
    }
    const auto bytes = words.size() == 3 ? parse<std::size_t>(words[2]) : std::nullopt;
    if (!bytes)
      return answer(-EINVAL);
    read_buffer(*bytes);
  }

  void open(ServedDevice &device, const Words &words) {
    if (buffer_)
      return answer(-EBUSY);
    const auto samples = words.size() >= 4 ? parse<std::size_t>(words[2]) : std::nullopt;
    if (!samples || words.size() > 4 || !device.frames) // CYCLIC is for outputs
      return answer(-EINVAL);
    auto opened = std::make_unique<OpenBuffer>(context_, device);
    const int error = opened->buffer.open(*samples, words[3]);
    if (error)
      return answer(-error);
    std::optional<Run> left;
    {
      const std::lock_guard lock(context_.mutex);
      left = context_.left.take(device, words[3]);
    }
    opened->buffer.begin(std::move(left));
    buffer_ = std::move(opened);
    answer(0);
  }

  /// As iiod: a buffer that does not fill in time is -ETIMEDOUT and answers -EBADF from then on.
  /// What was there is not lost, though: the client's next buffer goes on with it. At the end of a
  /// recording comes what is left of it, then -ENODATA, which no device has: this is no device that
  /// is slow, and waiting or trying again brings nothing.
  void read_buffer(std::size_t bytes) {
    const std::size_t frames = buffer_->buffer.frames_in(bytes);
    if (frames == 0)
      return answer(-EINVAL);
    const auto due = buffer_->buffer.due(frames);
    const auto give_up = IiodBuffer::Clock::now() + timeout_;
    const bool in_time = timeout_.count() == 0 || due <= give_up;
    wait_until(in_time ? due : give_up);
    if (!in_time) {
      leave_run();
      return answer(-ETIMEDOUT);
    }
    if (buffer_->buffer.produce(frames) == 0)
      return answer(-ENODATA);
    const std::string_view data = buffer_->buffer.data();
    send_all(std::to_string(data.size()) + "\n" + buffer_->buffer.mask_text() + "\n");
    send_all(data);
    if (data.size() < bytes)
      answer(0);
  }

  void leave_run() {
    const std::string mask = buffer_->buffer.mask_text();
    const ServedDevice &device = buffer_->device();
    Run run = buffer_->buffer.leave();
    buffer_.reset();
    const std::lock_guard lock(context_.mutex);
    context_.left.leave(device, mask, std::move(run));
  }

  int fd_, stop_fd_;
  ServedContext &context_;
  const IiodServer::FaultHook &faults_;
  std::string input_;
  std::chrono::milliseconds timeout_ = kDefaultTimeout;
  std::unique_ptr<OpenBuffer> buffer_;
};

} // namespace

void serve_iiod_connection(int fd, int stop_fd, ServedContext &context,
                           const IiodServer::FaultHook &faults) {
  Connection(fd, stop_fd, context, faults).serve();
}

} // namespace ada
