// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <memory>
#include <string>

#include "recording/capture_file.h"

namespace ada {

/// Writer of the text form; "-" is standard output. Volts carry six decimals (more where the
/// converter's step asks for it), times six, or nine where they fall between microseconds.
std::unique_ptr<CaptureWriter>
open_text_writer(const std::string &path, const CaptureMetadata &meta, const ChannelSet &channels);

} // namespace ada
