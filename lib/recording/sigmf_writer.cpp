// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/sigmf_writer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include <zlib.h>

#include "base/atomic_file.h"
#include "base/mapped_file.h"
#include "recording/fixed_point.h"
#include "recording/frame_check.h"
#include "recording/sigmf_meta.h"
#include "recording/sigmf_reader.h"

namespace ada {

namespace {

/// What the data file holds; each can only be given up, not gained, while frames come.
struct Form {
  bool counts = false;  ///< voltages as codes of the converter
  bool regular = false; ///< no time channel: the sample rate and the segments say the time
};

bool is_voltage_of_sensor(const Column &column) {
  return column.field == &Frame::vsin_v || column.field == &Frame::vcos_v ||
         column.field == &Frame::vtemp_v;
}

/// Frames to bytes in one form. VDD and the reference are no channels of the converter and stay
/// doubles.
class Encoder {
public:
  Encoder(const CaptureMetadata &meta, const ChannelSet &present, Form form) : form_(form) {
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
      items_.push_back({&column, volts});
    }
    // As IIO does: the timestamp comes last.
    if (!form.regular) {
      std::rotate(channels.begin(), channels.begin() + 1, channels.end());
      std::rotate(items_.begin(), items_.begin() + 1, items_.end());
    }
    frame_bytes = place_channels(channels);
    buffer_.resize(frame_bytes);
  }

  /// The bytes of a frame, or nothing when a voltage is no code of the converter.
  std::optional<std::span<const std::byte>> encode(const Frame &frame) {
    for (std::size_t i = 0; i < channels.size(); ++i) {
      const SigmfChannel &channel = channels[i];
      const double value = frame.*items_[i].column->field;
      if (channel.type.is_float) {
        store(channel, std::bit_cast<std::uint64_t>(value));
      } else if (channel.name == "time_s") {
        store(channel, static_cast<std::uint64_t>(to_steps(value, power_of_ten(kTimeDecimals))));
      } else if (const auto code = code_of(channel, value, items_[i].steps)) {
        store(channel, *code);
      } else {
        return std::nullopt;
      }
    }
    return buffer_;
  }

  Form form() const { return form_; }

  std::vector<SigmfChannel> channels;
  std::size_t frame_bytes = 0;

private:
  struct Item {
    const Column *column;
    double steps; ///< decimal steps a volt
  };

  /// The code whose voltage is `value` in the resolution of the text form.
  static std::optional<std::uint64_t> code_of(const SigmfChannel &channel, double value,
                                              double steps) {
    const double code = std::nearbyint(value / channel.scale);
    if (!(code >= 0 && code < std::exp2(channel.type.word.bits)) ||
        to_steps(code * channel.scale, steps) != to_steps(value, steps))
      return std::nullopt;
    return static_cast<std::uint64_t>(code);
  }

  void store(const SigmfChannel &channel, std::uint64_t word) {
    for (unsigned i = 0; i < channel.type.word.word_bytes(); ++i)
      buffer_[channel.byte + i] = static_cast<std::byte>(word >> (8 * i));
  }

  Form form_;
  std::vector<Item> items_;
  std::vector<std::byte> buffer_;
};

class SigmfWriter final : public CaptureWriter {
public:
  SigmfWriter(const std::string &path, const CaptureMetadata &meta, const ChannelSet &channels)
      : check_(meta, channels), data_path_(sigmf_data_path(path)),
        meta_file_(sigmf_meta_path(path)), data_file_(new_data_file()),
        encoder_(meta, channels, first_form(meta)) {
    if (meta_file_.in_place() || data_file_->in_place())
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, path + ": SigMF needs two regular files");
  }

  void metadata(std::string_view key, std::string_view value) override {
    check_.add_metadata(key, value);
  }

  void mark_gap() override { gap_marked_ = true; }

  void write(std::span<const Frame> frames) override {
    for (const Frame &frame : frames) {
      check_.accept(frame);
      place_in_time(frame);
      write_frame(frame);
      last_time_ = frame.time_s;
    }
  }

  void finish() override {
    check_.require_frames();
    SigmfMeta meta;
    meta.meta = check_.meta();
    meta.channels = encoder_.channels;
    meta.frame_bytes = encoder_.frame_bytes;
    meta.segments = segments_;
    meta.data_crc32 = crc_;
    meta_file_.write(sigmf_meta_to_json(meta));
    // The meta file comes last: its checksum tells a data file of another recording.
    data_file_->sync();
    meta_file_.sync();
    data_file_->commit();
    meta_file_.commit();
  }

private:
  /// Codes of more than 32 bits have no SigMF datatype.
  static Form first_form(const CaptureMetadata &meta) {
    const double bits = meta.adc_bits.value_or(0);
    const bool counts = meta.adc_reference_v && bits >= 1 && bits <= 32 && bits == std::floor(bits);
    return {counts, meta.sample_rate_hz.has_value()};
  }

  std::unique_ptr<AtomicFile> new_data_file() const {
    return std::make_unique<AtomicFile>(data_path_);
  }

  /// Begins a segment where one is due, and gives up the regular clock where it does not hold.
  void place_in_time(const Frame &frame) {
    const std::size_t index = check_.frames() - 1;
    if (index == 0 || is_gap(frame)) {
      begin_segment(frame, index);
    } else if (encoder_.form().regular) {
      const double expected = regular_time(segments_.back(), index, *check_.meta().sample_rate_hz);
      constexpr double kNanoseconds = 1e9;
      if (to_steps(expected, kNanoseconds) != to_steps(frame.time_s, kNanoseconds))
        recode({encoder_.form().counts, false});
    }
    gap_marked_ = false;
  }

  bool is_gap(const Frame &frame) const {
    const auto rate = check_.meta().sample_rate_hz;
    return gap_marked_ || (rate && (frame.time_s - last_time_) * *rate > 1.5);
  }

  void begin_segment(const Frame &frame, std::size_t index) {
    SigmfSegment segment{index, index, frame.time_s};
    if (!segments_.empty()) {
      const auto &last = segments_.back();
      const double step = (frame.time_s - last_time_) * check_.meta().sample_rate_hz.value_or(0.0);
      const auto missing = step > 1.5 && step < 1e15 ? std::llround(step) - 1 : 0;
      segment.global_index =
          last.global_index + (index - last.sample_start) + static_cast<std::uint64_t>(missing);
    }
    // A clock with gaps everywhere is an irregular clock.
    if (encoder_.form().regular && segments_.size() > 16 && segments_.size() > index / 16)
      recode({encoder_.form().counts, false});
    if (segments_.size() < kMaxSigmfSegments)
      segments_.push_back(segment);
    else if (encoder_.form().regular)
      recode({encoder_.form().counts, false});
  }

  void write_frame(const Frame &frame) {
    auto bytes = encoder_.encode(frame);
    if (!bytes) {
      recode({false, encoder_.form().regular});
      bytes = encoder_.encode(frame);
    }
    put(*bytes);
  }

  void put(std::span<const std::byte> bytes) {
    crc_ = static_cast<std::uint32_t>(crc32(crc_, reinterpret_cast<const Bytef *>(bytes.data()),
                                            static_cast<uInt>(bytes.size())));
    data_file_->write(bytes.data(), bytes.size());
  }

  /// Writes what is there anew in another form.
  void recode(Form form) {
    const std::size_t written = check_.frames() - 1;
    SigmfMeta old;
    old.meta = check_.meta();
    old.channels = encoder_.channels;
    old.frame_bytes = encoder_.frame_bytes;
    old.segments = segments_;
    encoder_ = Encoder(check_.meta(), check_.channels(), form);
    if (written == 0)
      return;
    data_file_->flush();
    const std::unique_ptr<AtomicFile> old_file = std::exchange(data_file_, new_data_file());
    const MappedFile bytes(old_file->working_path());
    crc_ = 0;
    constexpr std::size_t kBlock = 4096;
    for (std::size_t first = 0; first < written; first += kBlock)
      recode_block(old, bytes.bytes(), first, std::min(kBlock, written - first));
  }

  void recode_block(const SigmfMeta &old, std::span<const std::byte> bytes, std::size_t first,
                    std::size_t count) {
    Capture block;
    const auto frames = bytes.subspan(first * old.frame_bytes, count * old.frame_bytes);
    for (const Column &column : kColumns) {
      std::vector<double> &values = block.*column.values;
      const SigmfChannel *channel = old.find(column.name);
      if (channel == nullptr && column.field != &Frame::time_s)
        continue;
      values.resize(count);
      if (channel == nullptr) {
        recode_time_.fill(old, first, values);
      } else if (column.field == &Frame::time_s && !channel->type.is_float) {
        std::vector<std::int64_t> steps(count);
        decode_integers(*channel, frames, old.frame_bytes, steps.data());
        std::transform(steps.begin(), steps.end(), values.begin(),
                       [](std::int64_t n) { return static_cast<double>(n) / 1e9; });
      } else {
        decode_channel(*channel, frames, old.frame_bytes, values.data());
      }
    }
    for (std::size_t i = 0; i < count; ++i)
      put(*encoder_.encode(frame_at(block, i)));
  }

  /// Times of a regular file, found by segment.
  struct RegularTime {
    void fill(const SigmfMeta &meta, std::size_t first, std::vector<double> &out) const {
      auto next =
          std::upper_bound(meta.segments.begin(), meta.segments.end(), first,
                           [](std::size_t i, const SigmfSegment &s) { return i < s.sample_start; });
      for (std::size_t i = 0; i < out.size(); ++i) {
        if (next != meta.segments.end() && next->sample_start == first + i)
          ++next;
        out[i] = regular_time(*std::prev(next), first + i, *meta.meta.sample_rate_hz);
      }
    }
  };

  FrameCheck check_;
  std::string data_path_;
  AtomicFile meta_file_;
  std::unique_ptr<AtomicFile> data_file_;
  Encoder encoder_;
  RegularTime recode_time_;
  std::vector<SigmfSegment> segments_;
  std::uint32_t crc_ = 0;
  double last_time_ = 0;
  bool gap_marked_ = false;
};

} // namespace

std::unique_ptr<CaptureWriter> open_sigmf_writer(const std::string &path,
                                                 const CaptureMetadata &meta,
                                                 const ChannelSet &channels) {
  return std::make_unique<SigmfWriter>(path, meta, channels);
}

} // namespace ada
