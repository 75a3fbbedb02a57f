// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "acquisition/network_buffer.h"

#include <algorithm>
#include <cerrno>
#include <charconv>

#include <fmt/format.h>

#include "acquisition/server_connection.h"

namespace ada {

namespace {

constexpr unsigned kMaskBits = 32, kMaskDigits = 8;

class NetworkBuffer final : public IioBuffer {
public:
  explicit NetworkBuffer(const NetworkBufferOptions &o)
      : wanted_(o.wanted), connection_(o.host, o.port, o.timeout, o.cancellation), bytes_(o.bytes),
        mask_((o.channels.size() + kMaskBits - 1) / kMaskBits), seen_(mask_.size()),
        mask_text_(mask_.size() * kMaskDigits + 1),
        read_command_(fmt::format("READBUF {} {}\r\n", o.device, o.bytes)) {
    for (const IioChannel &channel : o.channels) {
      formats_.push_back(channel.format);
      indices_.push_back(channel.index);
    }
    for (const std::size_t i : wanted_)
      mask_[i / kMaskBits] |= 1u << i % kMaskBits;
    // The server is to give up first, and say so. One without these commands is no reason to fail.
    connection_.send(fmt::format("TIMEOUT {}\r\n", o.timeout.count() / 2));
    connection_.number();
    connection_.send(fmt::format("SET {} BUFFERS_COUNT {}\r\n", o.device, o.kernel_buffers));
    connection_.number();
    std::string words;
    for (auto word = mask_.rbegin(); word != mask_.rend(); ++word)
      words += fmt::format("{:08x}", *word);
    connection_.send(fmt::format("OPEN {} {} {}\r\n", o.device, o.frames, words));
    if (const long answer = connection_.number(); answer < 0)
      throw ServerFailed{static_cast<int>(std::min<long>(-answer, 4095))};
    lay_out(mask_);
    connection_.stand_alone();
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
    } catch (const ServerFailed &failed) {
      return -failed.error;
    }
  }

  const std::byte *data() const override { return bytes_.data(); }
  bool exchange(UntouchedBytes &other) override {
    if (other.size() != bytes_.size())
      other.resize(bytes_.size());
    bytes_.swap(other);
    return true;
  }
  int poll_fd() const override { return -1; }
  void cancel() noexcept override { connection_.cancel(); }
  const FrameLayout &layout() override { return layout_; }

private:
  /// Hexadecimal words, the highest first. The server sends every channel that any client wants.
  void read_mask() {
    connection_.receive(mask_text_.data(), mask_text_.size());
    const auto *text = reinterpret_cast<const char *>(mask_text_.data());
    if (text[mask_text_.size() - 1] != '\n') // what follows would be taken for samples
      throw Error(ADA4571_ERROR_IO, "the server says in more words than it has channels which of "
                                    "them it sends: do not trust it");
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const char *word = text + (seen_.size() - 1 - i) * kMaskDigits;
      const auto [end, error] = std::from_chars(word, word + kMaskDigits, seen_[i], 16);
      if (error != std::errc{} || end != word + kMaskDigits || (seen_[i] & mask_[i]) != mask_[i])
        throw ServerFailed{EBADMSG};
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
  ServerConnection connection_;
  UntouchedBytes bytes_;
  std::vector<unsigned> mask_, seen_, laid_out_; ///< what was asked for, came last, layout_ is of
  std::vector<std::byte> mask_text_;
  std::string read_command_;
  FrameLayout layout_;
};

} // namespace

std::string server_port(const std::string &uri) {
  constexpr std::string_view kUsual = "30431";
  if (!uri.starts_with("ip:"))
    return {};
  const std::string host = uri.substr(3);
  const std::size_t colon = host.rfind(':');
  const bool has_port = colon != host.npos && (colon == host.find(':') || host[colon - 1] == ']');
  return has_port ? host.substr(colon + 1) : std::string(kUsual);
}

std::unique_ptr<IioBuffer> open_network_buffer(const NetworkBufferOptions &options, int &error) {
  try {
    return std::make_unique<NetworkBuffer>(options);
  } catch (const ServerFailed &failed) {
    error = failed.error;
    return nullptr;
  }
}

} // namespace ada
