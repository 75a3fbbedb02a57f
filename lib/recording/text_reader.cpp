// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/text_reader.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "base/descriptor.h"
#include "base/memory.h"
#include "recording/capture_file.h"
#include "recording/identity.h"
#include "recording/text_recording.h"
#include "recording/text_rows.h"

namespace ada {

namespace {

/// Bytes of numbers that are read from what is no file, 22 million rows of six columns: a pipe may
/// have no end. And a part of the memory, as a column that grows is there twice meanwhile, and what
/// is to be done with them needs some, too.
constexpr double kMostBytes = double{1 << 30}, kMostOfMemory = 1.0 / 8;
constexpr std::size_t kRowsAtOnce = std::size_t{1} << 16;

std::size_t most_rows(std::size_t columns) {
  return static_cast<std::size_t>(std::min(kMostBytes, kMostOfMemory * memory_bytes()) /
                                  static_cast<double>(columns * sizeof(double)));
}

} // namespace

Capture read_text_capture(int fd, const std::string &shown) {
  LineReader lines(fd, shown);
  TextHead head = read_text_head(lines);
  TextRows::Store columns;
  const ChannelSet channels = head.rows.channels();
  const auto present = static_cast<std::size_t>(std::count_if(
      kColumns.begin(), kColumns.end(), [&channels](const Column &c) { return channels.has(c); }));
  const std::size_t most = most_rows(present);
  std::size_t rows = 0, blank_line = 0;
  for (std::size_t got = kRowsAtOnce; got == kRowsAtOnce; rows += got) {
    if (rows >= most)
      throw Error(ADA4571_ERROR_NO_MEMORY,
                  fmt::format("{}: this has no end after {} rows, and what is no regular file is "
                              "held in memory, up to {:.3g} GB: save it as a file first, which is "
                              "read part by part",
                              shown, rows,
                              1e-9 * static_cast<double>(most * present * sizeof(double))));
    const TextRows::Count count =
        head.rows.read(lines, kAllColumns, kRowsAtOnce, columns, blank_line);
    got = count.rows;
    blank_line = count.blank_line;
  }
  if (rows == 0)
    lines.fail(1, "there is no row after the header line");
  Capture capture;
  capture.meta = std::move(head.meta);
  capture.ignored_columns = std::move(head.ignored_columns);
  for (std::size_t c = 0; c < kColumns.size(); ++c)
    capture.*kColumns[c].values = std::move(columns[c]);
  capture.gaps = gaps_in_time(capture);
  capture.identity = capture_identity(capture);
  return capture;
}

std::shared_ptr<const Recording> open_text_recording(const std::string &path) {
  const bool input = path == "-";
  const Descriptor fd(input ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY));
  if (fd.get() < 0)
    throw system_error(errno, path, "cannot open");
  const std::string shown = input ? "standard input" : path;
  struct stat info {};
  if (!input && ::fstat(fd.get(), &info) == 0 && S_ISREG(info.st_mode) && info.st_size > 0)
    return text_recording(fd.get(), shown);
  return recording_of(std::make_shared<const Capture>(read_text_capture(fd.get(), shown)));
}

Capture read_text_capture(const std::string &path) {
  return *open_text_recording(path)->whole();
}

} // namespace ada
