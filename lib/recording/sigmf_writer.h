// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <memory>
#include <string>

#include "recording/capture_file.h"

namespace ada {

/// Writer of SigMF; `path` names either of the two files. The data file holds converter counts as
/// long as the samples are such (adc_bits and adc_reference_v known), doubles otherwise, and a
/// time channel only when the clock is not regular. Both are found out while writing: the first
/// frame that does not fit makes the file be recoded once.
std::unique_ptr<CaptureWriter>
open_sigmf_writer(const std::string &path, const CaptureMetadata &meta, const ChannelSet &channels);

} // namespace ada
