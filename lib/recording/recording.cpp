// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/recording.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "recording/gap_detector.h"
#include "recording/identity.h"
#include "recording/sigmf_reader.h"
#include "recording/text_reader.h"

namespace ada {

namespace {

class RecordingInMemory final : public Recording {
public:
  explicit RecordingInMemory(std::shared_ptr<const Capture> capture)
      : capture_(std::move(capture)) {
    facts_.meta = capture_->meta;
    facts_.starts = capture_->starts;
    facts_.gaps = capture_->gaps;
    facts_.data_file = capture_->data_file;
    facts_.ignored_columns = capture_->ignored_columns;
    facts_.identity = capture_->identity;
    channels_ = ChannelSet::of(*capture_);
    size_ = capture_->size();
    if (size_ > 0) {
      first_time_s_ = capture_->time_s.front();
      last_time_s_ = capture_->time_s.back();
    }
  }

  std::size_t blocks() const override { return size_ > 0 ? 1 : 0; }
  std::size_t block_begin(std::size_t block) const override { return block > 0 ? size_ : 0; }
  void read(std::size_t, std::size_t offset, std::size_t count, ColumnMask wanted,
            Block &out) const override {
    out.first = std::min(offset, size_);
    out.count = std::min(count, size_ - out.first);
    for (std::size_t c = 0; c < kColumns.size(); ++c) {
      const auto &values = (*capture_).*kColumns[c].values;
      const bool there = (wanted & 1u << c) != 0 && !values.empty();
      out.*kColumns[c].block =
          there ? std::span(values).subspan(out.first, out.count) : std::span<const double>();
    }
  }
  std::shared_ptr<const Capture> whole() const override { return capture_; }

private:
  std::shared_ptr<const Capture> capture_;
};

/// What has to be held as a whole leaves the other half of the machine's memory to others; beyond
/// that the system would end whatever it likes.
void check_fits_memory(std::size_t samples, std::size_t columns) {
  const double bytes = static_cast<double>(samples) * static_cast<double>(columns * sizeof(double));
  const double memory = memory_bytes();
  if (bytes > 0.5 * memory)
    throw Error(ADA4571_ERROR_NO_MEMORY,
                fmt::format("this has to hold the recording as a whole, {} samples in {:.3g} GB: more "
                            "than half of this program's memory of {:.3g} GB",
                            samples, 1e-9 * bytes, 1e-9 * memory));
}

} // namespace

std::size_t Recording::block_of(std::size_t sample) const {
  std::size_t low = 0, high = blocks();
  while (high - low > 1) {
    const std::size_t middle = low + (high - low) / 2;
    (block_begin(middle) <= sample ? low : high) = middle;
  }
  return low;
}

double Recording::time_s(std::size_t sample) const {
  Block block;
  const std::size_t k = block_of(sample);
  read(k, sample - block_begin(k), 1, kTimeColumn, block);
  return block.time_s.front();
}

const std::vector<std::size_t> &Recording::jumps() const {
  std::call_once(once_jumps_, [this] {
    if (regular_)
      return; // time jumps where a gap is noted, and nowhere else
    GapDetector gap;
    in_order<Block>(
        blocks(), [this](std::size_t k, Block &block) { read(k, kTimeColumn, block); },
        [&](std::size_t, const Block &block) {
          for (std::size_t i = 0; i < block.count; ++i)
            if (gap(block.time_s[i]))
              jumps_.push_back(block.first + i);
        });
  });
  return jumps_;
}

const std::string &Recording::identity() const {
  std::call_once(once_identity_, [this] {
    identity_ = facts_.identity.empty() ? recording_identity(*this) : facts_.identity;
  });
  return identity_;
}

Capture Recording::materialise() const {
  Capture out = facts_;
  check_fits_memory(size_, static_cast<std::size_t>(std::count_if(
                               kColumns.begin(), kColumns.end(),
                               [this](const Column &c) { return channels_.has(c); })));
  for (std::size_t c = 0; c < kColumns.size(); ++c)
    if (channels_.has(kColumns[c]))
      (out.*kColumns[c].values).resize(size_);
  for_each_block<Block>(blocks(), [&](std::size_t k, Block &block) {
    read(k, kAllColumns, block);
    for (const Column &column : kColumns)
      std::copy((block.*column.block).begin(), (block.*column.block).end(),
                (out.*column.values).begin() + static_cast<std::ptrdiff_t>(block.first));
  });
  out.identity = identity();
  return out;
}

std::shared_ptr<const Capture> Recording::whole() const {
  std::call_once(once_whole_, [this] { whole_ = std::make_shared<const Capture>(materialise()); });
  return whole_;
}

std::shared_ptr<const Recording> recording_of(std::shared_ptr<const Capture> capture) {
  return std::make_shared<RecordingInMemory>(std::move(capture));
}

std::shared_ptr<const Recording> recording_of(const Capture &capture) {
  return recording_of(std::shared_ptr<const Capture>(std::shared_ptr<void>(), &capture));
}

std::shared_ptr<const Recording> open_recording(const std::string &path) {
  return is_sigmf(path) ? open_sigmf_recording(path) : open_text_recording(path);
}

} // namespace ada
