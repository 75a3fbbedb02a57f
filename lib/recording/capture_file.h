// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Captures as files, whatever their form: text (.csv) or SigMF (.sigmf-meta with .sigmf-data).
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "acquisition/raw_frames.h"
#include "base/frame.h"
#include "recording/capture.h"
#include "recording/columns.h"
#include "recording/recording.h"

namespace ada {

/// Reads and validates the whole file; nothing half-read is returned. SigMF where the name says
/// so, text otherwise; "-" is standard input. Throws Error(ADA4571_ERROR_FORMAT) with file, line
/// and column.
Capture read_capture(const std::string &path);

/// Writes frames as they come. The file appears under its name only with finish(); the destructor
/// without it leaves nothing behind. (A growing one is otherwise: growing_writer.h.)
class CaptureWriter {
public:
  virtual ~CaptureWriter() = default;
  /// A further pair, before the first frame; the format's own keys come from the CaptureMetadata.
  virtual void metadata(std::string_view key, std::string_view value) = 0;
  /// Time must not decrease, and every channel of the file must be a finite number: what is
  /// written can be read again. Throws Error(ADA4571_ERROR_INVALID_ARGUMENT).
  virtual void write(std::span<const Frame> frames) = 0;
  /// Whether write_raw() is to be used in the place of write().
  virtual bool takes_raw() const { return false; }
  /// Frames of the form that the writer was opened for, `shift_ns` later than they say; another
  /// form is Error(ADA4571_ERROR_UNUSABLE_DATA).
  virtual void write_raw(const RawFrames &frames, std::int64_t shift_ns);
  /// Frames are missing before the next one. The text form shows that by its time column alone.
  virtual void mark_gap() {}
  /// Throws Error(ADA4571_ERROR_STATE) when no frame was written.
  virtual void finish() = 0;
};

/// The form follows from the extension; another one is Error(ADA4571_ERROR_INVALID_ARGUMENT).
std::unique_ptr<CaptureWriter> open_capture_writer(const std::string &path,
                                                   const CaptureMetadata &meta,
                                                   const ChannelSet &channels);

void write_recording(const Recording &recording, const std::string &path);
void write_capture(const Capture &capture, const std::string &path);

/// Whether most steps of time are about one period of the stated rate; not where none is stated.
bool times_follow_rate(const Capture &capture);

/// First sample after each step of time that is longer than one and a half sample periods; none
/// where the times do not follow the rate.
std::vector<std::size_t> gaps_in_time(const Capture &capture);

} // namespace ada
