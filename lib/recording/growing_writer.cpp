// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/growing_writer.h"

#include <algorithm>
#include <cerrno>
#include <cmath>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/checksum.h"
#include "base/descriptor.h"
#include "base/file_bytes.h"
#include "recording/disk_syncer.h"
#include "recording/frame_check.h"
#include "recording/sigmf_encoder.h"
#include "recording/sigmf_pair.h"
#include "recording/sigmf_reader.h"
#include "recording/wall_clock.h"

namespace ada {

namespace {

constexpr double kStepWithoutRate_s = 1e-3; ///< from the last frame to one that continues it

class GrowingWriter final : public CaptureWriter {
public:
  GrowingWriter(const std::string &path, const CaptureMetadata &meta, const ChannelSet &channels,
                bool resume)
      : path_(path), check_(meta, channels), encoder_(meta, channels, SigmfForm()) {
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
    if (created_ && !syncer_)
      ::unlink((stem_ + ".sigmf-data").c_str());
  }

  void metadata(std::string_view key, std::string_view value) override {
    check_.add_metadata(key, value);
  }

  void mark_gap() override { gap_marked_ = true; }

  void write(std::span<const Frame> frames) override {
    if (frames.empty())
      return;
    naming_what_is_left([&] { add(frames); });
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
      begin(frames.front());
    bytes_.clear();
    for (Frame frame : frames) {
      check_.accept(frame);
      frame.time_s += shift_s_;
      place_in_time(frame);
      const auto bytes = *encoder_.encode(frame);
      bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }
    append();
    if (!syncer_)
      show();
    else if (segments_changed_)
      syncer_->put_meta(meta(std::nullopt));
    segments_changed_ = false;
  }

  void put_in_place() {
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
    out.channels = encoder_.channels;
    out.frame_bytes = encoder_.frame_bytes;
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
    if (!same_channels() || !old_.dataset.empty())
      refuse("it holds other channels, or in another form than `record` writes while it grows");
    const CaptureMetadata &mine = check_.meta();
    refuse_other("supply is", old_.meta.supply_v, mine.supply_v, " V");
    refuse_other("periods a turn are", old_.meta.periods_per_turn, mine.periods_per_turn, "");
    refuse_other("sample rate is", old_.meta.sample_rate_hz, mine.sample_rate_hz, " Hz");
    read_end(data);
  }

  bool same_channels() const {
    const auto &mine = encoder_.channels;
    return old_.frame_bytes == encoder_.frame_bytes &&
           std::equal(mine.begin(), mine.end(), old_.channels.begin(), old_.channels.end(),
                      [](const SigmfChannel &a, const SigmfChannel &b) {
                        return a.name == b.name && to_string(a.type) == to_string(b.type) &&
                               a.byte == b.byte;
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
    decode_channel(*old_.find("time_s"), data.read(end - old_.frame_bytes, old_.frame_bytes),
                   old_.frame_bytes, &last_time_);
    segments_ = old_.segments;
    std::erase_if(segments_, [this](const SigmfSegment &s) { return s.sample_start >= frames_; });
    datetime_ = old_.datetime;
  }

  /// With the first frame: the data file is there, or cut to whole frames.
  void begin(const Frame &first) {
    data_path_ = stem_ + ".sigmf-data";
    const std::string &data = data_path_;
    if (fd_.get() < 0)
      create(data);
    else if (::ftruncate(fd_.get(), static_cast<off_t>(frames_ * encoder_.frame_bytes)) != 0)
      throw system_error(errno, data, "cannot cut to whole frames");
    if (frames_ > 0)
      shift_s_ = time_of_continuation() - first.time_s;
    else
      datetime_ = utc_now();
    gap_marked_ = true;
    if (segments_.empty())
      segments_.push_back({0, 0, first.time_s});
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

  void place_in_time(const Frame &frame) {
    const auto rate = check_.meta().sample_rate_hz;
    const bool gap = gap_marked_ || (rate && (frame.time_s - last_time_) * *rate > 1.5);
    if (gap && frames_ > 0 && segments_.size() < kMaxSigmfSegments) {
      segments_.push_back(
          next_segment(segments_.back(), frames_, frame.time_s, last_time_, rate.value_or(0.0)));
      segments_changed_ = true;
    }
    gap_marked_ = false;
    last_time_ = frame.time_s;
    ++frames_;
  }

  /// A disk that fills up leaves whole frames.
  void append() {
    const off_t before = ::lseek(fd_.get(), 0, SEEK_END);
    try {
      write_all(fd_.get(), {reinterpret_cast<const char *>(bytes_.data()), bytes_.size()},
                data_path_);
    } catch (const Error &) {
      [[maybe_unused]] const int cut = ::ftruncate(fd_.get(), before);
      throw;
    }
    crc_ = crc32_of(bytes_, crc_);
  }

  std::string path_, stem_; ///< as asked for; where it grows, without the end
  std::string data_path_;   ///< once it grows: no write makes the name anew
  FrameCheck check_;
  SigmfEncoder encoder_;
  SigmfMeta old_; ///< of the recording that goes on; frame_bytes 0: there is none
  Descriptor claim_; ///< the old recording, while another grows to replace it
  Descriptor fd_;
  bool created_ = false; ///< the data file is ours
  std::unique_ptr<DiskSyncer> syncer_; ///< since the first frame
  std::vector<std::byte> bytes_;
  std::vector<SigmfSegment> segments_;
  std::string datetime_; ///< when the first frame came
  std::size_t frames_ = 0;
  double shift_s_ = 0, last_time_ = 0;
  std::uint32_t crc_ = 0;
  bool gap_marked_ = false, segments_changed_ = false;
};

} // namespace

std::unique_ptr<CaptureWriter> open_growing_writer(const std::string &path,
                                                   const CaptureMetadata &meta,
                                                   const ChannelSet &channels, bool resume) {
  if (!is_sigmf(path))
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                path + ": only a SigMF recording (.sigmf-meta) can grow and be continued");
  return std::make_unique<GrowingWriter>(path, meta, channels, resume);
}

} // namespace ada
