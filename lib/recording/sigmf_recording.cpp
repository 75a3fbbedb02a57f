// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/sigmf_recording.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/checksum.h"
#include "base/columns_of_numbers.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/text.h"
#include "recording/rate_steps.h"
#include "recording/sigmf_reader.h"

namespace ada {

namespace {

/// Frames a block: all columns of one, as doubles, fit into a second-level cache.
constexpr std::size_t kBlockFrames = 16384;

/// What the check of one block finds, put together in order.
struct Checked {
  Block block;
  std::uint32_t crc = 0;
  RateSteps steps;
};

class SigmfRecording final : public Recording {
public:
  SigmfRecording(const SigmfMeta &meta, FileBytes data, const std::string &shown)
      : meta_(meta), data_(std::move(data)), shown_(shown) {
    check_size();
    facts_.meta = meta_.meta;
    if (data_.is_file())
      facts_.data_file = shown_;
    for (const SigmfChannel &channel : meta_.channels)
      add(channel);
    channels_ = {has(kVtempColumn), has(kVddColumn), has(kReferenceColumn)};
    regular_ = !has(kTimeColumn);
    if (regular_ && !meta_.meta.sample_rate_hz)
      fail("there is neither a channel time_s nor core:sample_rate in the meta file");
    find_time_origin();
    for (std::size_t i = 1; i < meta_.segments.size(); ++i)
      facts_.gaps.push_back(meta_.segments[i].sample_start);
    check_blocks();
    if (regular_)
      check_segments();
  }

  std::size_t blocks() const override { return (size_ + kBlockFrames - 1) / kBlockFrames; }
  std::size_t block_begin(std::size_t block) const override {
    return std::min(block * kBlockFrames, size_);
  }

  void read(std::size_t block, std::size_t offset, std::size_t count, ColumnMask wanted,
            Block &out) const override {
    place(block, offset, count, out);
    const ColumnMask in_file = regular_ ? kAllColumns & ~kTimeColumn : kAllColumns;
    decode(wanted & in_file ? frames(out.first, out.count) : BytesRead({}), wanted, out);
  }

  std::optional<RawPairs> raw_pairs(std::size_t block) const override {
    const SigmfChannel &sin = *columns_[1], &cos = *columns_[2];
    SampleType whole;
    whole.word.is_signed = sin.type.word.is_signed;
    whole.word.big_endian = std::endian::native == std::endian::big;
    if (sin.type != whole || cos.type != whole || sin.scale != cos.scale ||
        sin.offset != cos.offset || sin.scale == 0 || meta_.frame_bytes != 4)
      return std::nullopt;
    const std::size_t begin = block_begin(block);
    return RawPairs{frames(begin, block_begin(block + 1) - begin),
                    {sizeof(ada4571_layout), whole.word.is_signed ? ADA4571_S16 : ADA4571_U16,
                     meta_.frame_bytes, sin.scale, sin.offset, 0, 0},
                    cos.byte < sin.byte};
  }

private:
  /// Which samples of a block are meant.
  void place(std::size_t block, std::size_t offset, std::size_t count, Block &out) const {
    const std::size_t end = block_begin(block + 1);
    out.first = std::min(block_begin(block) + offset, end);
    out.count = std::min(count, end - out.first);
  }

  /// The columns of these samples, whose frames they are.
  void decode(std::span<const std::byte> frames, ColumnMask wanted, Block &out) const {
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      std::span<const double> &column = out.*kColumns[c].block;
      column = {};
      const bool counted = c == 0 && regular_;
      if (!(wanted & 1u << c) || !(counted || has(1u << c)))
        continue;
      out.store[c].resize(std::max(out.store[c].size(), out.count));
      const std::span<double> values(out.store[c].data(), out.count);
      if (counted)
        count_time(out.first, values);
      else
        decode(*columns_[c], frames, out.first, values);
      column = values;
    }
  }

  [[noreturn]] void fail(const std::string &what) const {
    throw Error(ADA4571_ERROR_FORMAT, shown_ + ": " + what);
  }
  [[noreturn]] void fail_at(std::size_t sample, const std::string &what) const {
    fail("sample " + std::to_string(sample) + ": " + what);
  }
  [[noreturn]] void fail_backward(std::size_t sample, double before, double now) const {
    fail_at(sample, "time_s goes back from " + shortest(before) + " to " + shortest(now));
  }

  void check_size() {
    size_ = whole_frames(meta_, data_);
    if (size_ == 0)
      fail("there is no sample");
    if (!meta_.unfinished && data_.size() % meta_.frame_bytes != 0)
      fail("the file ends within a frame: " + std::to_string(data_.size()) +
           " bytes are no whole number of frames of " + std::to_string(meta_.frame_bytes) +
           " bytes");
    if (meta_.unfinished) // the meta file may have got further than the data
      std::erase_if(meta_.segments, [this](const auto &s) { return s.sample_start >= size_; });
    if (meta_.segments.back().sample_start >= size_)
      fail("a captures segment begins at sample " +
           std::to_string(meta_.segments.back().sample_start) + ", but there are " +
           std::to_string(size_));
  }

  void add(const SigmfChannel &channel) {
    for (std::size_t c = 0; c < kColumns.size(); ++c)
      if (kColumns[c].name == channel.name) {
        columns_[c] = &channel;
        return;
      }
    facts_.ignored_columns.push_back(channel.name);
  }
  bool has(ColumnMask column) const { return columns_[std::countr_zero(column)] != nullptr; }

  BytesRead frames(std::size_t first, std::size_t count) const {
    return data_.read(first * meta_.frame_bytes, count * meta_.frame_bytes);
  }

  /// A channel of frames, of which the first is that of sample `first`.
  void decode(const SigmfChannel &channel, std::span<const std::byte> frames, std::size_t first,
              std::span<double> out) const {
    if (&channel == columns_[0] && !channel.type.is_float)
      decode_timestamps(channel, frames, first, out);
    else
      decode_channel(channel, frames, meta_.frame_bytes, out.data());
  }

  /// Timestamps are nanoseconds from any origin: the first sample is at the time of the first
  /// segment. The subtraction is of integers, as a double could not tell nanoseconds of today's
  /// clock apart.
  static constexpr double kNanoseconds = 1e9;

  void find_time_origin() {
    if (regular_ || columns_[0]->type.is_float)
      return;
    decode_integers(*columns_[0], frames(0, 1), meta_.frame_bytes, &first_timestamp_);
    start_ns_ = std::llround(meta_.segments.front().time_s * kNanoseconds);
  }

  void decode_timestamps(const SigmfChannel &channel, std::span<const std::byte> frames,
                         std::size_t first, std::span<double> out) const {
    std::array<std::int64_t, 1024> block;
    for (std::size_t i = 0; i < out.size(); i += block.size()) {
      const std::size_t count = std::min(block.size(), out.size() - i);
      decode_integers(channel, frames.subspan(i * meta_.frame_bytes, count * meta_.frame_bytes),
                      meta_.frame_bytes, block.data());
      for (std::size_t k = 0; k < count; ++k) {
        std::int64_t elapsed = 0;
        if (__builtin_sub_overflow(block[k], first_timestamp_, &elapsed) ||
            __builtin_add_overflow(elapsed, start_ns_, &elapsed))
          fail_at(first + i + k, "time_s is out of range");
        out[i + k] = static_cast<double>(elapsed) / kNanoseconds;
      }
    }
  }

  /// Without a time channel the sample rate counts, anew in each segment.
  void count_time(std::size_t first, std::span<double> out) const {
    const auto after = [](std::size_t i, const SigmfSegment &s) { return i < s.sample_start; };
    auto next = std::upper_bound(meta_.segments.begin(), meta_.segments.end(), first, after);
    for (std::size_t i = 0; i < out.size(); ++next) {
      const SigmfSegment segment = *std::prev(next);
      const std::size_t end = next == meta_.segments.end()
                                  ? out.size()
                                  : std::min(out.size(), next->sample_start - first);
      regular_times(segment.time_s, first + i - segment.sample_start, *meta_.meta.sample_rate_hz,
                    end - i, out.data() + i);
      i = end;
    }
  }

  void check_blocks() {
    ColumnMask checked = 0;
    for (std::size_t c = 0; c < kColumns.size(); ++c)
      if (columns_[c] && (c == 0 || !always_within(*columns_[c], kColumns[c].limit)))
        checked |= 1u << c;
    if (checked == 0 && !meta_.data_crc32)
      return;
    std::uint32_t crc = 0;
    RateSteps steps(meta_.meta.sample_rate_hz);
    in_order<Checked>(
        blocks(), [&](std::size_t k, Checked &c) { check_block(k, checked, c); },
        [&](std::size_t k, Checked &c) {
          crc = crc32_joined(crc, c.crc, c.block.count * meta_.frame_bytes);
          if (!regular_)
            join_times(k, c, steps);
        });
    if (meta_.data_crc32 && *meta_.data_crc32 != crc)
      fail("the data does not fit the checksum in the meta file");
    std::vector<std::size_t> both;
    const std::vector<std::size_t> seen = steps.gaps();
    std::set_union(facts_.gaps.begin(), facts_.gaps.end(), seen.begin(), seen.end(),
                   std::back_inserter(both));
    facts_.gaps = std::move(both);
  }

  void check_block(std::size_t k, ColumnMask wanted, Checked &out) const {
    Block &block = out.block;
    place(k, 0, size_, block);
    const BytesRead read = frames(block.first, block.count);
    const std::span<const std::byte> bytes = read;
    decode(bytes, wanted, block);
    if (meta_.data_crc32)
      out.crc = crc32_of(bytes);
    for (const Column &column : kColumns) {
      const auto values = block.*column.block;
      for (std::size_t i = 0; i < values.size(); ++i)
        if (!(std::fabs(values[i]) <= column.limit))
          fail_at(block.first + i,
                  std::string(column.name) +
                      (std::isnan(values[i]) ? " is not a number" : " is out of range"));
    }
    out.steps = RateSteps(meta_.meta.sample_rate_hz);
    for (std::size_t i = 1; i < block.time_s.size(); ++i)
      check_step(block.first + i, block.time_s[i - 1], block.time_s[i], out.steps);
  }

  void check_step(std::size_t sample, double before, double now, RateSteps &steps) const {
    if (now < before)
      fail_backward(sample, before, now);
    steps.add(sample, now - before);
  }

  /// Of a recording with times of its own.
  void join_times(std::size_t k, const Checked &c, RateSteps &steps) {
    if (k == 0)
      first_time_s_ = c.block.time_s.front();
    else
      check_step(c.block.first, last_time_s_, c.block.time_s.front(), steps);
    steps.append(c.steps);
    last_time_s_ = c.block.time_s.back();
  }

  void check_segments() {
    const auto time = [this](std::size_t i) {
      double t = 0;
      count_time(i, {&t, 1});
      return t;
    };
    for (std::size_t i = 1; i < meta_.segments.size(); ++i) {
      const std::size_t sample = meta_.segments[i].sample_start;
      if (time(sample) < time(sample - 1))
        fail_backward(sample, time(sample - 1), time(sample));
    }
    first_time_s_ = time(0);
    last_time_s_ = time(size_ - 1);
  }

  SigmfMeta meta_;
  FileBytes data_;
  std::string shown_;
  std::array<const SigmfChannel *, kColumnCount> columns_{}; ///< in the order of kColumns
  std::int64_t first_timestamp_ = 0, start_ns_ = 0;
};

} // namespace

std::shared_ptr<const Recording> sigmf_recording(const SigmfMeta &meta, FileBytes data,
                                                 const std::string &shown) {
  return std::make_shared<SigmfRecording>(meta, std::move(data), shown);
}

} // namespace ada
