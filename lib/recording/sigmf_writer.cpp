// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/sigmf_writer.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "base/atomic_file.h"
#include "base/checksum.h"
#include "base/file_bytes.h"
#include "recording/fixed_point.h"
#include "recording/frame_check.h"
#include "recording/sigmf_encoder.h"
#include "recording/sigmf_meta.h"
#include "recording/sigmf_pair.h"
#include "recording/sigmf_reader.h"

namespace ada {

namespace {

class SigmfWriter final : public CaptureWriter {
public:
  SigmfWriter(const std::string &path, const CaptureMetadata &meta, const ChannelSet &channels)
      : check_(meta, channels), path_(path), data_file_(new_data_file()),
        encoder_(meta, channels, first_form(meta)) {
    // What cannot be put in place is better known before the work.
    claim_sigmf_pair(path);
    if (AtomicFile(sigmf_meta_path(path)).in_place() || data_file_->in_place())
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
    const std::string data = free_sigmf_stem(path_) + ".sigmf-data";
    data_file_->commit_as(data);
    publish_sigmf_pair(path_, meta, data, IfRefused::remove);
  }

private:
  /// Codes of more than 32 bits have no SigMF datatype.
  static SigmfForm first_form(const CaptureMetadata &meta) {
    const double bits = meta.adc_bits.value_or(0);
    const bool counts = meta.adc_reference_v && bits >= 1 && bits <= 32 && bits == std::floor(bits);
    return {counts, meta.sample_rate_hz.has_value()};
  }

  std::unique_ptr<AtomicFile> new_data_file() const {
    return std::make_unique<AtomicFile>(sigmf_data_path(path_));
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
    if (!segments_.empty())
      segment = next_segment(segments_.back(), index, frame.time_s, last_time_,
                             check_.meta().sample_rate_hz.value_or(0.0));
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
    crc_ = crc32_of(bytes, crc_);
    data_file_->write(bytes.data(), bytes.size());
  }

  /// Writes what is there anew in another form.
  void recode(SigmfForm form) {
    const std::size_t written = check_.frames() - 1;
    SigmfMeta old;
    old.meta = check_.meta();
    old.channels = encoder_.channels;
    old.frame_bytes = encoder_.frame_bytes;
    old.segments = segments_;
    encoder_ = SigmfEncoder(check_.meta(), check_.channels(), form);
    if (written == 0)
      return;
    data_file_->flush();
    const std::unique_ptr<AtomicFile> old_file = std::exchange(data_file_, new_data_file());
    const FileBytes bytes(old_file->fd(), path_);
    crc_ = 0;
    constexpr std::size_t kBlock = 4096;
    for (std::size_t first = 0; first < written; first += kBlock)
      recode_block(old, bytes, first, std::min(kBlock, written - first));
  }

  void recode_block(const SigmfMeta &old, const FileBytes &bytes, std::size_t first,
                    std::size_t count) {
    Capture block;
    const BytesRead frames = bytes.read(first * old.frame_bytes, count * old.frame_bytes);
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
  std::string path_;
  std::unique_ptr<AtomicFile> data_file_;
  SigmfEncoder encoder_;
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
