// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <string>

#include "recording/capture.h"

namespace ada {

/// Reads a capture in text form, "-" from standard input, block by block: beside the columns only
/// a block of the file is in memory. docs/recordings.md has the format.
Capture read_text_capture(const std::string &path);

/// The same from an open descriptor; `shown` names it in messages.
Capture read_text_capture(int fd, const std::string &shown);

} // namespace ada
