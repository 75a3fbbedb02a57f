// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "simulation/iiod_buffer.h"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <cmath>

namespace ada {

namespace {

/// Frames that are made at a time.
constexpr std::size_t kPiece = 1024;

std::atomic<std::size_t> held{0}; ///< bytes, by all buffers of the process

/// Bit i of a mask of words of 32 bits, the highest word first; false where it has too few.
bool mask_bit(std::string_view mask, std::size_t i) {
  const std::size_t words = mask.size() / 8, word = i / 32;
  if (word >= words)
    return false;
  std::uint32_t value = 0;
  const char *at = mask.data() + 8 * (words - 1 - word);
  std::from_chars(at, at + 8, value, 16);
  return (value >> (i % 32)) & 1u;
}

} // namespace

BufferMemory::~BufferMemory() {
  held -= bytes_;
}

bool BufferMemory::take(std::size_t bytes) {
  std::size_t now = held.load();
  do {
    if (bytes > kMostBufferBytes - now)
      return false;
  } while (!held.compare_exchange_weak(now, now + bytes));
  bytes_ = bytes;
  return true;
}

int IiodBuffer::open(std::size_t samples, std::string_view mask) {
  const std::size_t channels = device_.channels.size();
  if (mask.size() != 8 * ((channels + 31) / 32) ||
      mask.find_first_not_of("0123456789abcdefABCDEF") != std::string_view::npos)
    return EINVAL;
  std::vector<ScanFormat> formats;
  for (std::size_t i = 0; i < 32 * (mask.size() / 8); ++i) {
    const ServedChannel *channel = i < channels ? &device_.channels[i] : nullptr;
    const bool scan = channel && channel->index >= 0,
               timestamp = scan && channel->id == "timestamp";
    if (mask_bit(mask, i)) {
      if (!scan)
        return EINVAL;
      elements_.push_back({channel->format, columns_, timestamp});
      formats.push_back(channel->format);
    }
    if (scan && !timestamp)
      ++columns_;
  }
  layout_ = compute_layout(formats);
  if (formats.empty() || samples == 0)
    return EINVAL;
  if (samples > kMostBufferBytes / layout_.frame_bytes ||
      !memory_.take(samples * layout_.frame_bytes))
    return ENOMEM;
  mask_ = mask;
  counts_.resize(std::min(samples, kPiece) * columns_);
  bytes_.assign(samples * layout_.frame_bytes, '\0');
  return 0;
}

void IiodBuffer::begin(std::optional<Run> left) {
  if (left) {
    run_ = std::move(*left);
    return;
  }
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  run_ = {device_.frames(), 0, Clock::now(),
          std::chrono::duration_cast<std::chrono::nanoseconds>(now).count()};
}

std::size_t IiodBuffer::frames_in(std::size_t bytes) const {
  return std::min(bytes, bytes_.size()) / layout_.frame_bytes;
}

double IiodBuffer::time_of(std::uint64_t frame) const {
  if (device_.time_s)
    return device_.time_s(frame);
  return device_.rate_hz > 0.0 ? static_cast<double>(frame) / device_.rate_hz
                               : 1e-9 * static_cast<double>(frame);
}

IiodBuffer::Clock::time_point IiodBuffer::due(std::size_t frames) const {
  if (device_.rate_hz <= 0.0)
    return Clock::now();
  const double seconds = time_of(run_.produced + frames - 1) + 1.0 / device_.rate_hz;
  return run_.began +
         std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

std::size_t IiodBuffer::produce(std::size_t frames) {
  std::size_t made = 0;
  for (bool more = true; more && made < frames;) {
    const std::size_t n = std::min(frames - made, kPiece);
    const std::size_t came = run_.stream->next(std::span(counts_).first(n * columns_), n);
    lay_down(made, came);
    made += came;
    more = came == n;
  }
  used_ = made * layout_.frame_bytes;
  run_.produced += made;
  return made;
}

void IiodBuffer::lay_down(std::size_t first, std::size_t frames) {
  char *const begin = bytes_.data() + first * layout_.frame_bytes;
  std::fill_n(begin, frames * layout_.frame_bytes, '\0'); // the kernel's padding is zero
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Element &element = elements_[e];
    char *at = begin + layout_.offsets[e];
    for (std::size_t i = 0; i < frames; ++i, at += layout_.frame_bytes) {
      const std::uint64_t frame = run_.produced + first + i;
      const std::int64_t value = element.timestamp
                                     ? run_.began_ns + std::llround(1e9 * time_of(frame))
                                     : counts_[i * columns_ + element.column];
      put(at, element.format, value);
    }
  }
}

void IiodBuffer::put(char *at, const ScanFormat &format, std::int64_t value) const {
  const unsigned bytes = format.word_bytes();
  auto word = static_cast<std::uint64_t>(value);
  if (format.bits < 64)
    word &= (std::uint64_t{1} << format.bits) - 1;
  word <<= format.shift;
  for (unsigned r = 0; r < format.repeat; ++r, at += bytes)
    for (unsigned i = 0; i < bytes; ++i) {
      const unsigned place = format.big_endian ? bytes - 1 - i : i;
      at[i] = static_cast<char>((word >> (8 * place)) & 0xff);
    }
}

} // namespace ada
