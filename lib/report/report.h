// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The diagnosis as one self-contained HTML page.
#pragma once

#include <string>

#include "diagnosis/words/result.h"
#include "recording/capture.h"

namespace ada {

/// Writes the page whole or not at all. A plot that gnuplot does not draw is missing from it, and
/// the page says why. Throws Error when the file cannot be written.
void write_report(const Diagnosis &diagnosis, const Capture &capture, const std::string &path);

} // namespace ada
