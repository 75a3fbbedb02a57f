// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/capture_file.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "base/robust.h"
#include "recording/sigmf_reader.h"
#include "recording/sigmf_writer.h"
#include "recording/text_reader.h"
#include "recording/text_writer.h"

namespace ada {

namespace {

/// Sample periods from one sample to the next: beyond, one is missing between them.
constexpr double kLongestStep = 1.5;

} // namespace

namespace {

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() > end.size() && text.substr(text.size() - end.size()) == end;
}

} // namespace

Capture read_capture(const std::string &path) {
  if (is_sigmf(path))
    return read_sigmf_capture(path);
  return read_text_capture(path);
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

void write_capture(const Capture &capture, const std::string &path) {
  const auto writer = open_capture_writer(path, capture.meta, ChannelSet::of(capture));
  std::array<Frame, 1024> block;
  auto gap = capture.gaps.begin();
  for (std::size_t first = 0, count = 0; first < capture.size(); first += count) {
    count = std::min(block.size(), capture.size() - first);
    if (gap != capture.gaps.end() && *gap == first) {
      writer->mark_gap();
      ++gap;
    }
    if (gap != capture.gaps.end() && *gap < first + count)
      count = *gap - first; // a block ends where a gap begins
    for (std::size_t i = 0; i < count; ++i)
      block[i] = frame_at(capture, first + i);
    writer->write({block.data(), count});
  }
  writer->finish();
}

bool times_follow_rate(const Capture &capture) {
  if (!capture.meta.sample_rate_hz)
    return false;
  const double periods = median_step(capture.time_s) * *capture.meta.sample_rate_hz;
  return periods <= kLongestStep && periods >= 1 / kLongestStep;
}

std::vector<std::size_t> gaps_in_time(const Capture &capture) {
  std::vector<std::size_t> gaps;
  if (!times_follow_rate(capture))
    return gaps;
  const double longest = kLongestStep / *capture.meta.sample_rate_hz;
  for (std::size_t i = 1; i < capture.size(); ++i)
    if (capture.time_s[i] - capture.time_s[i - 1] > longest)
      gaps.push_back(i);
  return gaps;
}

} // namespace ada
