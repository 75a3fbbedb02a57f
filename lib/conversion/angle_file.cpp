// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "conversion/angle_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <span>
#include <string_view>
#include <utility>

#include "base/atomic_file.h"
#include "base/checksum.h"
#include "base/error.h"
#include "base/parallel.h"
#include "recording/fixed_point.h"
#include "recording/sigmf_meta.h"
#include "recording/sigmf_pair.h"
#include "recording/sigmf_reader.h"

namespace ada {

namespace {

constexpr int kTimeDecimalsOut = 9, kAngleDecimals = 6;
constexpr std::size_t kNumberBytes = 352; ///< longest text of a double, with decimals
constexpr std::size_t kRowBytes = 3 * kNumberBytes + 16;

/// Any number, in text; `scale` is the power of ten of `decimals`.
char *print(char *out, double value, double scale, int decimals) {
  constexpr double kMostSteps = 9e15; // of doubles that count single steps
  if (std::fabs(value) * scale < kMostSteps)
    return print_steps(out, to_steps(value, scale), decimals);
  if (std::isnan(value))
    return std::copy_n("nan", 3, out);
  return std::to_chars(out, out + kNumberBytes, value, std::chars_format::fixed, decimals).ptr;
}

class AngleText final : public AngleFile {
public:
  AngleText(const std::string &path, double range_deg)
      : file_(path), // rounded up, an angle must not reach the end of its range
        last_deg_(range_deg - 0.5 / power_of_ten(kAngleDecimals)) {
    file_.write("time_s,angle_deg,radius,status\n");
  }

  void encode(const AngleBlock &angles, Bytes &out) const override {
    const double seconds = power_of_ten(kTimeDecimalsOut), degrees = power_of_ten(kAngleDecimals);
    std::size_t used = 0;
    for (std::size_t i = 0; i < angles.count(); ++i) {
      if (out.bytes.size() - used < kRowBytes)
        out.bytes.resize(std::max(2 * out.bytes.size(), 64 * angles.count() + kRowBytes));
      char *at = out.bytes.data() + used;
      const double angle = angles.angle_deg[i];
      at = print(at, angles.block.time_s[i], seconds, kTimeDecimalsOut);
      *at++ = ',';
      at = print(at, angle >= last_deg_ ? 0.0 : angle, degrees, kAngleDecimals);
      *at++ = ',';
      at = print(at, angles.radius[i], degrees, kAngleDecimals);
      *at++ = ',';
      at = std::to_chars(at, at + 10, angles.status[i]).ptr;
      *at++ = '\n';
      used = static_cast<std::size_t>(at - out.bytes.data());
    }
    out.bytes.resize(used);
  }

  bool holds_times() const override { return true; }
  void write(Bytes &bytes) override { file_.write(bytes.bytes.data(), bytes.bytes.size()); }
  void finish() override { file_.commit(); }

private:
  AtomicFile file_;
  double last_deg_;
};

/// Native words.
SampleType float_type(unsigned bits) {
  SampleType type;
  type.is_float = true;
  type.word.storage = type.word.bits = bits;
  type.word.big_endian = std::endian::native == std::endian::big;
  return type;
}

class AngleSigmf final : public AngleFile {
public:
  AngleSigmf(const std::string &path, const Recording &recording)
      : path_(path), recording_(recording), data_(sigmf_data_path(path)) {
    claim_sigmf_pair(path);
    if (AtomicFile(sigmf_meta_path(path)).in_place() || data_.in_place())
      throw Error(ADA4571_ERROR_INVALID_ARGUMENT, path + ": SigMF needs two regular files");
    meta_.meta = recording.meta();
    for (const char *name : {"angle_deg", "radius", "status"})
      meta_.channels.push_back({.name = name, .type = float_type(32)});
    if (!recording.regular())
      meta_.channels.push_back({.name = "time_s", .type = float_type(64)});
    meta_.frame_bytes = place_channels(meta_.channels);
    data_.expect(std::uint64_t{recording.size()} * meta_.frame_bytes);
    add_segments();
  }

  void encode(const AngleBlock &angles, Bytes &out) const override {
    const std::size_t count = angles.count(), step = meta_.frame_bytes;
    constexpr std::size_t kFloats = sizeof(float[3]);
    out.bytes.resize(count * step);
    std::vector<char> &floats = holds_times() ? out.floats : out.bytes;
    floats.resize(count * kFloats);
    frames_of_floats(angles.angle_deg.data(), angles.radius.data(), angles.status.data(), count,
                     static_cast<float>(360.0 / recording_.meta().periods_per_turn), floats.data());
    if (holds_times()) {
      const std::size_t time = meta_.channels[3].byte;
      char *frame = out.bytes.data();
      for (std::size_t i = 0; i < count; ++i, frame += step) {
        std::memcpy(frame, floats.data() + i * kFloats, kFloats);
        std::memset(frame + kFloats, 0, time - kFloats);
        std::memcpy(frame + time, &angles.block.time_s[i], sizeof(double));
      }
    }
    out.crc32 = crc32_of(std::as_bytes(std::span(out.bytes)));
  }

  /// The file gets several blocks at a time: a file system handles a megabyte with less work than
  /// blocks of the size that suits the kernels.
  void write(Bytes &bytes) override {
    crc_ = crc32_joined(crc_, bytes.crc32, bytes.bytes.size());
    std::swap(waiting_[filled_++], bytes.bytes);
    if (filled_ == waiting_.size())
      write_waiting();
  }

  bool holds_times() const override { return !recording_.regular(); }
  void finish() override {
    write_waiting();
    meta_.data_crc32 = crc_;
    const std::string data = free_sigmf_stem(path_) + ".sigmf-data";
    data_.commit_as(data);
    publish_sigmf_pair(path_, meta_, data, IfRefused::remove);
  }

private:
  void write_waiting() {
    std::array<std::string_view, kTogether> pieces;
    for (std::size_t k = 0; k < filled_; ++k)
      pieces[k] = {waiting_[k].data(), waiting_[k].size()};
    data_.write(std::span(pieces).first(filled_));
    filled_ = 0;
  }

  void add_segments() {
    meta_.segments.push_back({0, 0, recording_.first_time_s()});
    for (const std::size_t gap : recording_.facts().gaps) {
      if (gap == 0)
        continue;
      if (meta_.segments.size() == kMaxSigmfSegments)
        break;
      meta_.segments.push_back(next_segment(meta_.segments.back(), gap, recording_.time_s(gap),
                                            recording_.time_s(gap - 1),
                                            meta_.meta.sample_rate_hz.value_or(0.0)));
    }
  }

  std::string path_;
  const Recording &recording_;
  AtomicFile data_;
  SigmfMeta meta_;
  std::uint32_t crc_ = 0;
  static constexpr std::size_t kTogether = 8; ///< blocks of 16384 frames of 12 bytes: 1.5 MB
  std::array<std::vector<char>, kTogether> waiting_;
  std::size_t filled_ = 0;
};

std::unique_ptr<AngleFile> open_angles(const std::string &path, AngleForm form, double range_deg,
                                       const Recording &recording) {
  const bool named = is_sigmf(path);
  if (form == AngleForm::text && named)
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT, path + ": a file of this name is SigMF, no text");
  if (form == AngleForm::sigmf && !named)
    throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
                path + ": the name of a SigMF recording must end in .sigmf-meta");
  return named ? open_angle_sigmf(path, recording) : open_angle_text(path, range_deg);
}

/// A block on its way into the file.
struct Passing {
  AngleBlock angles;
  AngleFile::Bytes bytes;
};

void report(const AngleProgress &progress, const Block &block, const Recording &recording) {
  if (progress)
    progress(static_cast<double>(block.first + block.count) /
             static_cast<double>(recording.size()));
}

} // namespace

std::unique_ptr<AngleFile> open_angle_text(const std::string &path, double range_deg) {
  return std::make_unique<AngleText>(path, range_deg);
}

std::unique_ptr<AngleFile> open_angle_sigmf(const std::string &path, const Recording &recording) {
  return std::make_unique<AngleSigmf>(path, recording);
}

void save_angles(const Model &model, const Recording &recording, const std::string &path,
                 AngleForm form, const AngleProgress &progress) {
  const BlockConverter converter(model, recording);
  const auto file = open_angles(path, form, 360.0 / model.periods_per_turn, recording);
  recording.jumps(); // once, before the threads ask for it
  in_order<Passing>(
      recording.blocks(),
      [&](std::size_t k, Passing &p) {
        converter.convert(k, p.angles, file->holds_times());
        file->encode(p.angles, p.bytes);
      },
      [&](std::size_t, Passing &p) {
        file->write(p.bytes);
        report(progress, p.angles.block, recording);
      });
  file->finish();
}

void save_angles(const FrameConversion &convert, double range_deg, const Recording &recording,
                 const std::string &path, AngleForm form, const AngleProgress &progress) {
  const auto file = open_angles(path, form, range_deg, recording);
  std::vector<Frame> frames;
  std::vector<ada4571_angle> angles;
  in_order<Passing>(
      recording.blocks(),
      [&](std::size_t k, Passing &p) { recording.read(k, kAllColumns, p.angles.block); },
      [&](std::size_t, Passing &p) {
        const Block &block = p.angles.block;
        frames.resize(block.count);
        angles.resize(block.count);
        for (std::size_t i = 0; i < block.count; ++i)
          frames[i] = frame_at(block, i);
        convert(frames, angles);
        p.angles.resize(block.count);
        for (std::size_t i = 0; i < block.count; ++i)
          p.angles.set(i, angles[i]);
        file->encode(p.angles, p.bytes);
        file->write(p.bytes);
        report(progress, block, recording);
      });
  file->finish();
}

} // namespace ada
