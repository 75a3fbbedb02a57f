// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <memory>
#include <string>

#include "recording/recording.h"

namespace ada {

/// Opens a capture in text form, "-" from standard input; docs/recordings.md has the format. A
/// regular file is read and parsed block by block; a pipe is read into memory.
std::shared_ptr<const Recording> open_text_recording(const std::string &path);

/// The whole of it in memory.
Capture read_text_capture(const std::string &path);

/// The same from an open descriptor, from front to back; `shown` names it in messages.
Capture read_text_capture(int fd, const std::string &shown);

} // namespace ada
