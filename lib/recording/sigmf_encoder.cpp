// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/sigmf_encoder.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "recording/fixed_point.h"

namespace ada {

namespace {

bool is_voltage_of_sensor(const Column &column) {
  return column.field == &Frame::vsin_v || column.field == &Frame::vcos_v ||
         column.field == &Frame::vtemp_v;
}

/// The code whose voltage is `value` in the resolution of the text form.
std::optional<std::uint64_t> code_of(const SigmfChannel &channel, double value, double steps) {
  const double code = std::nearbyint(value / channel.scale);
  if (!(code >= 0 && code < std::exp2(channel.type.word.bits)) ||
      to_steps(code * channel.scale, steps) != to_steps(value, steps))
    return std::nullopt;
  return static_cast<std::uint64_t>(code);
}

} // namespace

SigmfEncoder::SigmfEncoder(const CaptureMetadata &meta, const ChannelSet &present, SigmfForm form)
    : form_(form) {
  const double volts = power_of_ten(volt_decimals(meta));
  for (const Column &column : kColumns) {
    const bool is_time = column.field == &Frame::time_s;
    if (!present.has(column) || (is_time && form.regular))
      continue;
    SigmfChannel channel;
    channel.name = column.name;
    if (form.counts && is_voltage_of_sensor(column)) {
      channel.type.word.bits = static_cast<unsigned>(*meta.adc_bits);
      channel.type.word.storage = channel.type.word.bits > 16 ? 32 : 16;
      channel.scale = *meta.adc_reference_v / std::exp2(*meta.adc_bits);
    } else if (form.counts && is_time) {
      channel.type.word = {.bits = 64, .storage = 64, .is_signed = true};
    } else {
      channel.type = parse_sample_type("le:f64");
    }
    channels.push_back(channel);
    items_.push_back({column.field, is_time, volts});
  }
  // As IIO does: the timestamp comes last.
  if (!form.regular) {
    std::rotate(channels.begin(), channels.begin() + 1, channels.end());
    std::rotate(items_.begin(), items_.begin() + 1, items_.end());
  }
  frame_bytes = place_channels(channels);
  buffer_.resize(frame_bytes);
}

std::optional<std::span<const std::byte>> SigmfEncoder::encode(const Frame &frame) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const SigmfChannel &channel = channels[i];
    const double value = frame.*items_[i].field;
    if (channel.type.is_float) {
      store(channel, std::bit_cast<std::uint64_t>(value));
    } else if (items_[i].is_time) {
      store(channel, static_cast<std::uint64_t>(to_steps(value, power_of_ten(kTimeDecimals))));
    } else if (const auto code = code_of(channel, value, items_[i].steps)) {
      store(channel, *code);
    } else {
      return std::nullopt;
    }
  }
  return buffer_;
}

void SigmfEncoder::store(const SigmfChannel &channel, std::uint64_t word) {
  if constexpr (std::endian::native == std::endian::big)
    word = __builtin_bswap64(word);
  std::byte *const at = buffer_.data() + channel.byte;
  if (channel.type.word.storage == 64) // of a known length: no call
    std::memcpy(at, &word, sizeof word);
  else
    std::memcpy(at, &word, channel.type.word.word_bytes());
}

} // namespace ada
