// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "recording/text_reader.h"

#include <cerrno>
#include <limits>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "base/descriptor.h"
#include "recording/capture_file.h"
#include "recording/identity.h"
#include "recording/text_recording.h"
#include "recording/text_rows.h"

namespace ada {

Capture read_text_capture(int fd, const std::string &shown) {
  LineReader lines(fd, shown);
  TextHead head = read_text_head(lines);
  TextRows::Store columns;
  if (head.rows.read(lines, kAllColumns, std::numeric_limits<std::size_t>::max(), columns).rows ==
      0)
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
