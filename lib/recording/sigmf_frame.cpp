// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/sigmf_frame.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "base/error.h"
#include "base/text.h"

namespace ada {

namespace {

struct Datatype {
  std::string_view name;
  bool is_float, is_signed;
  unsigned storage;
};

constexpr Datatype kDatatypes[] = {
    {"rf32", true, true, 32},   {"rf64", true, true, 64}, {"ri32", false, true, 32},
    {"ri16", false, true, 16},  {"ri8", false, true, 8},  {"ru32", false, false, 32},
    {"ru16", false, false, 16}, {"ru8", false, false, 8},
};

template <class Float, class Word>
void decode_floats(const SigmfChannel &channel, const std::byte *from, std::size_t stride,
                   std::size_t count, double *out) {
  const bool swap = channel.type.word.big_endian != (std::endian::native == std::endian::big);
  for (std::size_t i = 0; i < count; ++i, from += stride) {
    Word word;
    std::memcpy(&word, from, sizeof word);
    if (swap) {
      if constexpr (sizeof(Word) == 8)
        word = __builtin_bswap64(word);
      else
        word = __builtin_bswap32(word);
    }
    out[i] = (static_cast<double>(std::bit_cast<Float>(word)) + channel.offset) * channel.scale;
  }
}

ElementDecoder decoder(const SigmfChannel &channel) {
  return {channel.type.word, LinearScale{channel.offset, channel.scale}, channel.name};
}

} // namespace

SampleType parse_sample_type(std::string_view text) {
  SampleType type;
  if (text == "le:f32" || text == "le:f64" || text == "be:f32" || text == "be:f64") {
    type.is_float = true;
    type.word.big_endian = text[0] == 'b';
    type.word.storage = type.word.bits = text[4] == '3' ? 32 : 64;
    return type;
  }
  type.word = parse_scan_format(text);
  validate(type.word, text);
  return type;
}

std::string to_string(const SampleType &type) {
  if (type.is_float)
    return (type.word.big_endian ? "be:f" : "le:f") + std::to_string(type.word.storage);
  return to_string(type.word);
}

SampleType type_of_datatype(std::string_view datatype) {
  std::string_view kind = datatype;
  const bool big = kind.ends_with("_be"), ordered = big || kind.ends_with("_le");
  if (ordered)
    kind.remove_suffix(3);
  for (const Datatype &known : kDatatypes) {
    if (known.name != kind || (!ordered && known.storage > 8))
      continue;
    SampleType type;
    type.is_float = known.is_float;
    type.word.is_signed = known.is_signed;
    type.word.storage = type.word.bits = known.storage;
    type.word.big_endian = big;
    return type;
  }
  throw Error(ADA4571_ERROR_FORMAT,
              "the datatype " + excerpt(datatype) +
                  " is none of the real ones of SigMF (ri16_le, ru16_be, rf32_le, ru8, ...)");
}

std::string datatype_of(const SampleType &type) {
  for (const Datatype &known : kDatatypes)
    if (known.is_float == type.is_float && known.storage == type.word.storage &&
        (known.is_float || known.is_signed == type.word.is_signed))
      return std::string(known.name) + (known.storage == 8     ? ""
                                        : type.word.big_endian ? "_be"
                                                               : "_le");
  return {}; // 64-bit integers: SigMF has no name for them
}

bool always_within(const SigmfChannel &channel, double limit) {
  if (channel.type.is_float)
    return false;
  const double range = std::exp2(channel.type.word.bits);
  return (range + std::fabs(channel.offset)) * std::fabs(channel.scale) <= limit;
}

void decode_channel(const SigmfChannel &channel, std::span<const std::byte> frames,
                    std::size_t frame_bytes, double *out) {
  const std::size_t count = frames.size() / frame_bytes;
  const std::byte *first = frames.data() + channel.byte;
  if (!channel.type.is_float)
    decoder(channel).volts(first, frame_bytes, count, out, 1);
  else if (channel.type.word.storage == 32)
    decode_floats<float, std::uint32_t>(channel, first, frame_bytes, count, out);
  else
    decode_floats<double, std::uint64_t>(channel, first, frame_bytes, count, out);
}

void decode_integers(const SigmfChannel &channel, std::span<const std::byte> frames,
                     std::size_t frame_bytes, std::int64_t *out) {
  const ElementDecoder decode = decoder(channel);
  const std::byte *from = frames.data() + channel.byte;
  for (std::size_t i = 0; i < frames.size() / frame_bytes; ++i, from += frame_bytes)
    out[i] = decode.raw(from);
}

std::size_t place_channels(std::vector<SigmfChannel> &channels) {
  std::vector<ScanFormat> words;
  for (const SigmfChannel &channel : channels)
    words.push_back(channel.type.word);
  const FrameLayout layout = compute_layout(words);
  for (std::size_t i = 0; i < channels.size(); ++i)
    channels[i].byte = layout.offsets[i];
  return layout.frame_bytes;
}

SigmfSegment next_segment(const SigmfSegment &before, std::size_t index, double time_s,
                          double last_time_s, double rate_hz) {
  const double step = (time_s - last_time_s) * rate_hz;
  const auto missing = step > 1.5 && step < 1e15 ? std::llround(step) - 1 : 0;
  return {index,
          before.global_index + (index - before.sample_start) + static_cast<std::uint64_t>(missing),
          time_s};
}

} // namespace ada
