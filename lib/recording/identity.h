// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <string>

#include "recording/capture.h"

namespace ada {

/// Names the content of a capture: "crc32:1a2b3c4d/70000x6", the checksum over the columns in the
/// resolution of the text form (fixed_point.h), the samples and the columns. Metadata and gaps do
/// not count, so the name survives a change of the form and of the description.
std::string capture_identity(const Capture &capture);

} // namespace ada
