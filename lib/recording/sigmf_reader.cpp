// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/sigmf_reader.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <zlib.h>

#include "base/descriptor.h"
#include "base/error.h"
#include "base/mapped_file.h"
#include "base/text.h"
#include "recording/capture_file.h"
#include "recording/columns.h"
#include "recording/identity.h"

namespace ada {

namespace {

class Decoder {
public:
  Decoder(const SigmfMeta &meta, std::span<const std::byte> data, const std::string &shown)
      : meta_(meta), data_(data), shown_(shown) {}

  Capture run() {
    check_size();
    capture_.meta = meta_.meta;
    for (const SigmfChannel &channel : meta_.channels)
      decode(channel);
    if (meta_.find("time_s") == nullptr)
      count_time();
    check_time();
    for (std::size_t i = 1; i < meta_.segments.size(); ++i)
      capture_.gaps.push_back(meta_.segments[i].sample_start);
    add_gaps_in_time();
    capture_.identity = capture_identity(capture_);
    return std::move(capture_);
  }

private:
  [[noreturn]] void fail(const std::string &what) const {
    throw Error(ADA4571_ERROR_FORMAT, shown_ + ": " + what);
  }

  void check_size() {
    count_ = whole_frames(meta_, data_);
    if (count_ == 0)
      fail("there is no sample");
    if (!meta_.unfinished && data_.size() % meta_.frame_bytes != 0)
      fail("the file ends within a frame: " + std::to_string(data_.size()) +
           " bytes are no whole number of frames of " + std::to_string(meta_.frame_bytes) +
           " bytes");
    if (meta_.unfinished) { // the meta file may have got further than the data
      data_ = data_.first(count_ * meta_.frame_bytes);
      std::erase_if(meta_.segments, [this](const auto &s) { return s.sample_start >= count_; });
    }
    if (meta_.segments.back().sample_start >= count_)
      fail("a captures segment begins at sample " +
           std::to_string(meta_.segments.back().sample_start) + ", but there are " +
           std::to_string(count_));
    if (meta_.data_crc32 && *meta_.data_crc32 != checksum())
      fail("the data does not fit the checksum in the meta file");
  }

  std::uint32_t checksum() const {
    constexpr std::size_t kBlock = std::size_t{1} << 20;
    uLong crc = crc32(0, nullptr, 0);
    for (auto rest = data_; !rest.empty(); rest = rest.subspan(std::min(kBlock, rest.size())))
      crc = crc32(crc, reinterpret_cast<const Bytef *>(rest.data()),
                  static_cast<uInt>(std::min(kBlock, rest.size())));
    return static_cast<std::uint32_t>(crc);
  }

  void decode(const SigmfChannel &channel) {
    const auto column = std::find_if(kColumns.begin(), kColumns.end(),
                                     [&](const Column &c) { return c.name == channel.name; });
    if (column == kColumns.end()) {
      capture_.ignored_columns.push_back(channel.name);
      return;
    }
    std::vector<double> &values = capture_.*column->values;
    values.resize(count_);
    if (column->field == &Frame::time_s && !channel.type.is_float)
      decode_timestamps(channel, values);
    else
      decode_channel(channel, data_, meta_.frame_bytes, values.data());
    for (std::size_t i = 0; i < count_; ++i)
      if (!(std::fabs(values[i]) <= column->limit))
        fail("sample " + std::to_string(i) + ": " + channel.name +
             (std::isnan(values[i]) ? " is not a number" : " is out of range"));
  }

  /// Nanoseconds from any origin: the first sample is at the time of the first segment. The
  /// subtraction is of integers, as a double could not tell nanoseconds of today's clock apart.
  void decode_timestamps(const SigmfChannel &channel, std::vector<double> &values) const {
    constexpr double kNanoseconds = 1e9;
    std::vector<std::int64_t> block;
    const std::int64_t start = std::llround(meta_.segments.front().time_s * kNanoseconds);
    std::int64_t first = 0;
    for (std::size_t i = 0; i < count_; i += block.size()) {
      block.resize(std::min<std::size_t>(4096, count_ - i));
      decode_integers(channel,
                      data_.subspan(i * meta_.frame_bytes, block.size() * meta_.frame_bytes),
                      meta_.frame_bytes, block.data());
      if (i == 0)
        first = block.front();
      for (std::size_t k = 0; k < block.size(); ++k) {
        std::int64_t elapsed = 0;
        if (__builtin_sub_overflow(block[k], first, &elapsed) ||
            __builtin_add_overflow(elapsed, start, &elapsed))
          fail("sample " + std::to_string(i + k) + ": time_s is out of range");
        values[i + k] = static_cast<double>(elapsed) / kNanoseconds;
      }
    }
  }

  /// Without a time channel the sample rate counts, anew in each segment.
  void count_time() {
    if (!meta_.meta.sample_rate_hz)
      fail("there is neither a channel time_s nor core:sample_rate in the meta file");
    capture_.time_s.resize(count_);
    auto segment = meta_.segments.begin();
    for (std::size_t i = 0; i < count_; ++i) {
      if (std::next(segment) != meta_.segments.end() && i == std::next(segment)->sample_start)
        ++segment;
      capture_.time_s[i] = regular_time(*segment, i, *meta_.meta.sample_rate_hz);
    }
  }

  void check_time() const {
    const auto &time = capture_.time_s;
    for (std::size_t i = 1; i < count_; ++i)
      if (time[i] < time[i - 1])
        fail("sample " + std::to_string(i) + ": time_s goes back from " + shortest(time[i - 1]) +
             " to " + shortest(time[i]));
  }

  void add_gaps_in_time() {
    std::vector<std::size_t> both;
    const auto seen = gaps_in_time(capture_);
    std::set_union(capture_.gaps.begin(), capture_.gaps.end(), seen.begin(), seen.end(),
                   std::back_inserter(both));
    capture_.gaps = std::move(both);
  }

  SigmfMeta meta_;
  std::span<const std::byte> data_;
  const std::string &shown_;
  std::size_t count_ = 0;
  Capture capture_;
};

std::string with_end(const std::string &path, std::string_view end) {
  return path.substr(0, path.rfind('.')) + std::string(end);
}

} // namespace

bool is_sigmf(std::string_view path) {
  return path.ends_with(".sigmf-meta") || path.ends_with(".sigmf-data");
}

std::size_t whole_frames(const SigmfMeta &meta, std::span<const std::byte> data) {
  std::size_t count = data.size() / meta.frame_bytes;
  const auto is_blank = [&](std::size_t i) {
    const auto frame = data.subspan(i * meta.frame_bytes, meta.frame_bytes);
    return std::all_of(frame.begin(), frame.end(), [](std::byte b) { return b == std::byte{}; });
  };
  while (meta.unfinished && count > 0 && is_blank(count - 1))
    --count;
  return count;
}

std::string sigmf_meta_path(const std::string &path) {
  return with_end(path, ".sigmf-meta");
}
std::string sigmf_data_path(const std::string &path) {
  return with_end(path, ".sigmf-data");
}

Capture decode_sigmf(const SigmfMeta &meta, std::span<const std::byte> data,
                     const std::string &shown) {
  return Decoder(meta, data, shown).run();
}

SigmfMeta read_sigmf_meta(const std::string &meta_path) {
  const MappedFile json(meta_path);
  if (json.bytes().size() > kMaxSigmfMetaBytes)
    throw Error(ADA4571_ERROR_FORMAT, meta_path + ":1:1: the meta file is longer than " +
                                          std::to_string(kMaxSigmfMetaBytes) + " bytes");
  return parse_sigmf_meta(
      {reinterpret_cast<const char *>(json.bytes().data()), json.bytes().size()}, meta_path);
}

namespace {

/// A data file that is not there under the name that the meta file states has got the usual name in
/// the meantime; the checksum tells whether it is the one.
std::string data_path_of(const SigmfMeta &meta, const std::string &path) {
  const std::string usual = sigmf_data_path(path);
  if (meta.dataset.empty())
    return usual;
  const std::string stated = usual.substr(0, usual.rfind('/') + 1) + meta.dataset;
  return meta.data_crc32 && !file_id(stated) && file_id(usual) ? usual : stated;
}

/// Tells a file from the one that took its place, which may have got its inode.
struct Version {
  FileId id;
  std::int64_t written_s = 0, written_ns = 0;
  bool operator==(const Version &) const = default;
};

Version version_of(const std::string &path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0)
    return {};
  return {{info.st_dev, info.st_ino}, info.st_mtim.tv_sec, info.st_mtim.tv_nsec};
}

} // namespace

Capture read_sigmf_capture(const std::string &path) {
  const std::string meta_path = sigmf_meta_path(path);
  // Another program may replace the recording between its two files, again and again.
  constexpr int kTries = 64, kTriesOfOne = 4;
  for (int i = 1;; ++i) {
    const Version before = version_of(meta_path);
    const SigmfMeta meta = read_sigmf_meta(meta_path);
    const std::string data_path = data_path_of(meta, path);
    try {
      const MappedFile data(data_path);
      Capture capture = decode_sigmf(meta, data.bytes(), data_path);
      capture.data_file = data_path;
      return capture;
    } catch (const Error &) {
      // A meta file of the same moment may look like the one before it: a few tries all the same.
      if (i == kTries || (i >= kTriesOfOne && version_of(meta_path) == before))
        throw;
    }
  }
}

} // namespace ada
