// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/capture_file.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "recording/rate_steps.h"
#include "recording/sigmf_reader.h"
#include "recording/sigmf_writer.h"
#include "recording/text_writer.h"

namespace ada {

namespace {

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() > end.size() && text.substr(text.size() - end.size()) == end;
}

} // namespace

void CaptureWriter::write_raw(const RawFrames &, std::int64_t) {
  throw Error(ADA4571_ERROR_STATE, "this recording takes frames, no blocks of a device");
}

Capture read_capture(const std::string &path) {
  return *open_recording(path)->whole();
}

std::unique_ptr<CaptureWriter> open_capture_writer(const std::string &path,
                                                   const CaptureMetadata &meta,
                                                   const ChannelSet &channels) {
  if (path == "-" || ends_with(path, ".csv"))
    return open_text_writer(path, meta, channels);
  if (is_sigmf(path))
    return open_sigmf_writer(path, meta, channels);
  throw Error(ADA4571_ERROR_INVALID_ARGUMENT,
              path + ": the name of a capture must end in .csv or .sigmf-meta");
}

void write_recording(const Recording &recording, const std::string &path) {
  const auto writer = open_capture_writer(path, recording.meta(), recording.channels());
  const std::vector<std::size_t> &gaps = recording.facts().gaps;
  auto gap = gaps.begin();
  std::array<Frame, 1024> frames;
  Block block;
  for (std::size_t k = 0; k < recording.blocks(); ++k) {
    recording.read(k, kAllColumns, block);
    for (std::size_t i = 0, count = 0; i < block.count; i += count) {
      const std::size_t first = block.first + i;
      count = std::min(frames.size(), block.count - i);
      if (gap != gaps.end() && *gap == first) {
        writer->mark_gap();
        ++gap;
      }
      if (gap != gaps.end() && *gap < first + count)
        count = *gap - first; // what is written at once ends where a gap begins
      for (std::size_t n = 0; n < count; ++n)
        frames[n] = frame_at(block, i + n);
      writer->write({frames.data(), count});
    }
  }
  writer->finish();
}

void write_capture(const Capture &capture, const std::string &path) {
  write_recording(*recording_of(capture), path);
}

namespace {

RateSteps rate_steps(const Capture &capture) {
  RateSteps steps(capture.meta.sample_rate_hz);
  for (std::size_t i = 1; i < capture.size(); ++i)
    steps.add(i, capture.time_s[i] - capture.time_s[i - 1]);
  return steps;
}

} // namespace

bool times_follow_rate(const Capture &capture) {
  return rate_steps(capture).follow_rate();
}

std::vector<std::size_t> gaps_in_time(const Capture &capture) {
  return rate_steps(capture).gaps();
}

} // namespace ada
