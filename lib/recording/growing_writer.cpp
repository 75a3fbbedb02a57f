// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/growing_writer.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/checksum.h"
#include "base/descriptor.h"
#include "base/file_bytes.h"
#include "recording/disk_syncer.h"
#include "recording/frame_check.h"
#include "recording/room_ahead.h"
#include "recording/sigmf_encoder.h"
#include "recording/sigmf_pair.h"
#include "recording/sigmf_reader.h"
#include "recording/wall_clock.h"

namespace ada {

namespace {

constexpr double kStepWithoutRate_s = 1e-3; ///< from the last frame to one that continues it
constexpr double kGap = 1.5;                ///< sample periods; a longer step is a gap
constexpr double kNanoseconds = 1e9;
/// A sum of two times or timestamps fits into 64 bits of nanoseconds.
constexpr double kMaxRawTime_s = 4e9;

class GrowingWriter final : public CaptureWriter {
public:
  /// `raw`: the form of write_raw(), null for write().
  GrowingWriter(const std::string &path, const CaptureMetadata &meta, const ChannelSet &channels,
                const RawForm *raw, bool resume)
      : path_(path), check_(meta, channels), encoder_(meta, channels, SigmfForm()) {
    if (raw) {
      raw_ = *raw;
      channels_ = channels_of(*raw);
      frame_bytes_ = raw->frame_bytes;
    } else {
      channels_ = encoder_.channels;
      frame_bytes_ = encoder_.frame_bytes;
    }
    const bool there = file_id(sigmf_meta_path(path)) || file_id(sigmf_data_path(path));
    if (there && resume) {
      open_existing();
      return;
    }
    claim_ = claim_sigmf_pair(path); // of an old recording, until the new one takes its place
    stem_ = there ? free_sigmf_stem(path) : without_end(follow_links(sigmf_data_path(path)));
  }

  /// Where not one frame could be written and shown, nothing stays.
  ~GrowingWriter() override {
    give_room_back();
    if (created_ && !syncer_)
      ::unlink((stem_ + ".sigmf-data").c_str());
  }

  void metadata(std::string_view key, std::string_view value) override {
    check_.add_metadata(key, value);
  }

  void mark_gap() override { gap_marked_ = true; }

  void write(std::span<const Frame> frames) override {
    if (raw_)
      throw Error(ADA4571_ERROR_STATE, "this recording takes blocks of a device, no frames");
    if (frames.empty())
      return;
    naming_what_is_left([&] { add(frames); });
  }

  bool takes_raw() const override { return raw_.has_value(); }

  void write_raw(const RawFrames &frames, std::int64_t shift_ns) override {
    if (!raw_)
      return CaptureWriter::write_raw(frames, shift_ns);
    if (frames.count == 0)
      return;
    naming_what_is_left([&] {
      if (!(*frames.form == *raw_))
        throw Error(ADA4571_ERROR_UNUSABLE_DATA,
                    path_ + ": the device has other channels or scales than when the recording "
                            "began");
      add_raw(frames, shift_ns);
    });
  }

  void finish() override {
    check_.require_frames();
    naming_what_is_left([this] { put_in_place(); });
  }

private:
  /// What stands under another name than was asked for is not to be searched for.
  template <class Work> void naming_what_is_left(Work work) const {
    try {
      work();
    } catch (const Error &e) {
      const std::string meta_path = stem_ + ".sigmf-meta";
      if (!syncer_ || in_own_place() || !file_id(meta_path))
        throw;
      throw Error(e.status(), std::string(e.what()) + "; what was recorded is in " + meta_path);
    }
  }

  void add(std::span<const Frame> frames) {
    if (syncer_)
      syncer_->rethrow_failure();
    else
      begin(frames.front().time_s);
    bytes_.clear();
    for (Frame frame : frames) {
      check_.accept(frame);
      frame.time_s += shift_s_;
      place_in_time(frame.time_s);
      const auto bytes = *encoder_.encode(frame);
      bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    append(bytes_);
    announce();
  }

  void announce() {
    if (!syncer_)
      show();
    else if (segments_changed_)
      syncer_->put_meta(meta(std::nullopt));
    segments_changed_ = false;
  }

  void add_raw(const RawFrames &frames, std::int64_t shift_ns) {
    const auto seconds = [&](std::size_t i) {
      return (static_cast<double>(frames.time_ns(i)) + static_cast<double>(shift_ns)) /
             kNanoseconds;
    };
    if (std::fabs(seconds(0)) > kMaxRawTime_s ||
        std::fabs(seconds(frames.count - 1)) > kMaxRawTime_s)
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                  "frame " + std::to_string(check_.frames()) + ": time_s is out of range");
    check_.accept_all(seconds(0), seconds(frames.count - 1), frames.count);
    if (syncer_) {
      syncer_->rethrow_failure();
    } else {
      begin(seconds(0));
      shift_ns_ = std::llround(shift_s_ * kNanoseconds);
      if (frames_ == 0 && is_sound(frames.origin_ns)) // the timestamps stay as they are
        word_of_zero_ = frames.origin_ns - shift_ns;
    }
    shift_ns += shift_ns_;
    place_in_time(frames, shift_ns);
    append(restamped(frames, shift_ns));
    announce();
  }

  static bool is_sound(std::int64_t ns) {
    return std::fabs(static_cast<double>(ns)) <= kMaxRawTime_s * kNanoseconds;
  }

  /// Where timestamps do not tell the time, they are replaced by words that do.
  std::span<const std::byte> restamped(const RawFrames &frames, std::int64_t shift_ns) {
    const std::int64_t later = word_of_zero_ + shift_ns;
    if (frames.times_ns.empty() && later == frames.origin_ns)
      return frames.bytes;
    bytes_.assign(frames.bytes.begin(), frames.bytes.end());
    std::byte *at = bytes_.data() + raw_->timestamp_byte;
    for (std::size_t i = 0; i < frames.count; ++i, at += frame_bytes_) {
      const std::int64_t word = frames.time_ns(i) + later;
      std::memcpy(at, &word, sizeof word);
    }
    return bytes_;
  }

  void place_in_time(const RawFrames &frames, std::int64_t shift_ns) {
    const auto time = [&](std::size_t i) {
      return static_cast<double>(frames.time_ns(i) + shift_ns) / kNanoseconds;
    };
    const double rate = check_.meta().sample_rate_hz.value_or(0.0);
    const bool even = frames.times_ns.empty() &&
                      static_cast<double>(frames.longest_step_ns) / kNanoseconds * rate <= kGap;
    place_in_time(time(0));
    if (even) {
      frames_ += frames.count - 1;
      last_time_ = time(frames.count - 1);
    }
    for (std::size_t i = 1; !even && i < frames.count; ++i)
      place_in_time(time(i));
  }

  /// As SigMF names them; throws where a reader would refuse them.
  static std::vector<SigmfChannel> channels_of(const RawForm &form) {
    std::vector<SigmfChannel> out;
    for (const RawChannel &raw : form.channels) {
      const auto column = std::find_if(kColumns.begin(), kColumns.end(),
                                       [&](const Column &c) { return c.field == raw.target; });
      SigmfChannel channel{std::string(column->name),
                           {raw.format, false},
                           raw.byte,
                           raw.scale.scale_v,
                           raw.scale.offset};
      if (!always_within(channel, column->limit) || channel.scale == 0)
        throw Error(ADA4571_ERROR_UNSUPPORTED,
                    "the scale of " + channel.name +
                        " is none that a recording of integers can have");
      out.push_back(std::move(channel));
    }
    SigmfChannel time{"time_s", {}, form.timestamp_byte};
    time.type.word = {.bits = 64,
                      .storage = 64,
                      .is_signed = true,
                      .big_endian = std::endian::native == std::endian::big};
    out.push_back(std::move(time));
    return out;
  }

  void put_in_place() {
    give_room_back();
    syncer_->stop(); // what is to be on the disk is there, or this throws
    const SigmfMeta final = meta(crc_);
    if (in_own_place()) {
      write_sigmf_meta(final, stem_ + ".sigmf-meta");
      return;
    }
    publish_sigmf_pair(path_, final, stem_ + ".sigmf-data", IfRefused::keep, claim_);
    ::unlink((stem_ + ".sigmf-meta").c_str());
  }

  static std::string without_end(const std::string &path) {
    return path.substr(0, path.rfind('.'));
  }

  bool in_own_place() const { return stem_ == without_end(follow_links(sigmf_data_path(path_))); }

  SigmfMeta meta(std::optional<std::uint32_t> crc) const {
    SigmfMeta out;
    out.meta = old_.frame_bytes > 0 ? old_.meta : check_.meta();
    out.channels = channels_;
    out.frame_bytes = frame_bytes_;
    out.segments = segments_;
    out.data_crc32 = crc;
    out.unfinished = !crc;
    out.datetime = datetime_;
    return out;
  }

  [[noreturn]] void refuse(const std::string &why) const {
    throw Error(ADA4571_ERROR_UNUSABLE_DATA, path_ + ": cannot be continued: " + why);
  }

  void refuse_other(const char *what, std::optional<double> its, std::optional<double> mine,
                    const char *unit) const {
    const auto text = [unit](std::optional<double> value) {
      return value ? fmt::format("{:.15g}{}", *value, unit) : std::string("unknown");
    };
    if (its != mine)
      refuse("its " + std::string(what) + " " + text(its) + ", now it would be " + text(mine));
  }

  /// Looks at the recording that is to go on, and changes nothing yet.
  void open_existing() {
    stem_ = without_end(follow_links(sigmf_data_path(path_)));
    old_ = read_sigmf_meta(sigmf_meta_path(path_));
    const std::string data = stem_ + ".sigmf-data";
    fd_ = Descriptor(::open(data.c_str(), O_RDWR | O_APPEND | O_CLOEXEC | O_NOCTTY));
    if (fd_.get() < 0)
      throw system_error(errno, data, "cannot open");
    if (!lock_for_writing(fd_.get()))
      throw Error(ADA4571_ERROR_BUSY, data + ": another program is recording into this file");
    if (raw_ && old_.find("time_s") != nullptr && old_.find("time_s")->type.is_float)
      throw Error(ADA4571_ERROR_UNSUPPORTED, path_ + ": holds doubles, no words of a converter");
    if (!same_channels() || !old_.dataset.empty())
      refuse("it holds other channels, or in another form than `record` writes while it grows");
    const CaptureMetadata &mine = check_.meta();
    refuse_other("supply is", old_.meta.supply_v, mine.supply_v, " V");
    refuse_other("periods a turn are", old_.meta.periods_per_turn, mine.periods_per_turn, "");
    refuse_other("sample rate is", old_.meta.sample_rate_hz, mine.sample_rate_hz, " Hz");
    read_end(data);
  }

  bool same_channels() const {
    const auto &mine = channels_;
    return old_.frame_bytes == frame_bytes_ &&
           std::equal(mine.begin(), mine.end(), old_.channels.begin(), old_.channels.end(),
                      [](const SigmfChannel &a, const SigmfChannel &b) {
                        return a.name == b.name && to_string(a.type) == to_string(b.type) &&
                               a.byte == b.byte && a.scale == b.scale && a.offset == b.offset;
                      });
  }

  /// How far the data goes, when it ends, and its checksum.
  void read_end(const std::string &shown) {
    constexpr std::size_t kAtOnce = 65536; // bytes
    const FileBytes data(fd_.get(), shown);
    frames_ = whole_frames(old_, data);
    if (frames_ == 0)
      return;
    const std::size_t end = frames_ * old_.frame_bytes;
    for (std::size_t at = 0; at < end; at += kAtOnce)
      crc_ = crc32_of(data.read(at, std::min(kAtOnce, end - at)), crc_);
    if (old_.data_crc32 && *old_.data_crc32 != crc_)
      throw Error(ADA4571_ERROR_FORMAT, shown + ": the data does not fit the checksum in the meta "
                                                "file");
    segments_ = old_.segments;
    const SigmfChannel &time = *old_.find("time_s");
    const BytesRead last = data.read(end - old_.frame_bytes, old_.frame_bytes);
    if (raw_) {
      std::int64_t first_word = 0, last_word = 0;
      decode_integers(time, data.read(0, old_.frame_bytes), old_.frame_bytes, &first_word);
      decode_integers(time, last, old_.frame_bytes, &last_word);
      if (!is_sound(first_word) || !is_sound(last_word))
        refuse("its timestamps are out of range");
      word_of_zero_ = first_word - std::llround(segments_.front().time_s * kNanoseconds);
      last_time_ = static_cast<double>(last_word - word_of_zero_) / kNanoseconds;
    } else {
      decode_channel(time, last, old_.frame_bytes, &last_time_);
    }
    std::erase_if(segments_, [this](const SigmfSegment &s) { return s.sample_start >= frames_; });
    datetime_ = old_.datetime;
  }

  /// With the first frame: the data file is there, or cut to whole frames.
  void begin(double first_s) {
    data_path_ = stem_ + ".sigmf-data";
    const std::string &data = data_path_;
    if (fd_.get() < 0)
      create(data);
    else if (::ftruncate(fd_.get(), static_cast<off_t>(frames_ * frame_bytes_)) != 0)
      throw system_error(errno, data, "cannot cut to whole frames");
    if (frames_ > 0)
      shift_s_ = time_of_continuation() - first_s;
    else
      datetime_ = utc_now();
    gap_marked_ = true;
    if (segments_.empty())
      segments_.push_back({0, 0, first_s});
    if (!created_) // that the data grows is said before it does
      write_sigmf_meta(meta(std::nullopt), stem_ + ".sigmf-meta");
  }

  /// After the first frames: a meta file without one would be a recording that cannot be read.
  void show() {
    if (created_)
      write_sigmf_meta(meta(std::nullopt), stem_ + ".sigmf-meta");
    syncer_ = std::make_unique<DiskSyncer>(fd_.get(), stem_ + ".sigmf-data", stem_ + ".sigmf-meta");
  }

  void create(const std::string &data) {
    fd_ = Descriptor(
        ::open(data.c_str(), O_RDWR | O_APPEND | O_CREAT | O_EXCL | O_CLOEXEC | O_NOCTTY, 0666));
    if (fd_.get() < 0)
      throw system_error(errno, data, "cannot create");
    created_ = true;
    lock_for_writing(fd_.get());
    struct stat existing {};
    if (!in_own_place() && ::stat(sigmf_data_path(path_).c_str(), &existing) == 0)
      ::fchmod(fd_.get(), existing.st_mode & 07777);
  }

  /// By the clocks of both recordings where they make sense, else right after the last frame.
  double time_of_continuation() const {
    const double rate = check_.meta().sample_rate_hz.value_or(0.0);
    const double next = last_time_ + (rate > 0 ? 1.0 / rate : kStepWithoutRate_s);
    const double since = seconds_since(datetime_); // not a number where that is unknown
    const double by_clock = segments_.front().time_s + since;
    return by_clock > next && by_clock < 1e9 ? by_clock : next;
  }

  void place_in_time(double time_s) {
    const auto rate = check_.meta().sample_rate_hz;
    const bool gap = gap_marked_ || (rate && (time_s - last_time_) * *rate > kGap);
    if (gap && frames_ > 0 && segments_.size() < kMaxSigmfSegments) {
      segments_.push_back(
          next_segment(segments_.back(), frames_, time_s, last_time_, rate.value_or(0.0)));
      segments_changed_ = true;
    }
    gap_marked_ = false;
    last_time_ = time_s;
    ++frames_;
  }

  /// A disk that fills up leaves whole frames.
  void append(std::span<const std::byte> bytes) {
    const off_t before = ::lseek(fd_.get(), 0, SEEK_END);
    if (before >= 0)
      room_.provide(fd_.get(), static_cast<std::uint64_t>(before) + bytes.size());
    // Before they are written: the copy into the page cache takes them out of the processor's.
    const std::uint32_t crc = crc32_of(bytes, crc_);
    try {
      write_all(fd_.get(), {reinterpret_cast<const char *>(bytes.data()), bytes.size()},
                data_path_);
    } catch (const Error &) {
      [[maybe_unused]] const int cut = ::ftruncate(fd_.get(), before);
      throw;
    }
    crc_ = crc;
  }

  void give_room_back() noexcept {
    if (const off_t size = ::lseek(fd_.get(), 0, SEEK_END); size >= 0)
      room_.give_back(fd_.get(), static_cast<std::uint64_t>(size));
  }

  std::string path_, stem_; ///< as asked for; where it grows, without the end
  std::string data_path_;   ///< once it grows: no write makes the name anew
  FrameCheck check_;
  SigmfEncoder encoder_;
  std::optional<RawForm> raw_;
  std::vector<SigmfChannel> channels_;
  std::size_t frame_bytes_ = 0;
  std::int64_t word_of_zero_ = 0; ///< timestamp of a raw recording at time 0
  std::int64_t shift_ns_ = 0;     ///< shift_s_ of a raw recording
  SigmfMeta old_;                 ///< of the recording that goes on; frame_bytes 0: there is none
  Descriptor claim_;              ///< the old recording, while another grows to replace it
  Descriptor fd_;
  RoomAhead room_;
  bool created_ = false;               ///< the data file is ours
  std::unique_ptr<DiskSyncer> syncer_; ///< since the first frame
  std::vector<std::byte> bytes_;
  std::vector<SigmfSegment> segments_;
  std::string datetime_; ///< when the first frame came
  std::size_t frames_ = 0;
  double shift_s_ = 0, last_time_ = 0;
  std::uint32_t crc_ = 0;
  bool gap_marked_ = false, segments_changed_ = false;
};

void require_sigmf(const std::string &path) {
  if (!is_sigmf(path))
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                path + ": only a SigMF recording (.sigmf-meta) can grow and be continued");
}

} // namespace

std::unique_ptr<CaptureWriter> open_growing_writer(const std::string &path,
                                                   const CaptureMetadata &meta,
                                                   const ChannelSet &channels, bool resume) {
  require_sigmf(path);
  return std::make_unique<GrowingWriter>(path, meta, channels, nullptr, resume);
}

std::unique_ptr<CaptureWriter> open_growing_raw_writer(const std::string &path,
                                                       const CaptureMetadata &meta,
                                                       const RawForm &form, bool resume) {
  const auto has = [&form](double Frame::*field) {
    return std::any_of(form.channels.begin(), form.channels.end(),
                       [field](const RawChannel &c) { return c.target == field; });
  };
  require_sigmf(path);
  return std::make_unique<GrowingWriter>(
      path, meta, ChannelSet{has(&Frame::vtemp_v), has(&Frame::vdd_v), false}, &form, resume);
}

} // namespace ada
