// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <memory>
#include <string>

#include "recording/capture_file.h"

namespace ada {

/// Writer of a SigMF recording that is on the disk while it grows: from the first frame on both
/// files are there and can be read, about once a second what came is brought to the disk by a
/// thread of its own, and neither a crash nor a destructor without finish() takes it away. Where a
/// recording of the name is already there, the new one grows as NAME.NUMBER and takes its place
/// with finish().
///
/// With `resume` it goes on in the recording of the name, after a gap, if there is one. Throws
/// Error(ADA4571_ERROR_UNUSABLE_DATA) when that has other channels or was not made by this writer,
/// ADA4571_ERROR_BUSY when another program is recording into it.
std::unique_ptr<CaptureWriter> open_growing_writer(const std::string &path,
                                                   const CaptureMetadata &meta,
                                                   const ChannelSet &channels, bool resume);

/// The same for frames as the device gives them (write_raw()): the data file holds the converter's
/// words, and no sample is converted. Throws Error(ADA4571_ERROR_UNSUPPORTED) where a recording
/// cannot hold that form, or the one that is to go on has another one that write() can go on in.
std::unique_ptr<CaptureWriter> open_growing_raw_writer(const std::string &path,
                                                       const CaptureMetadata &meta,
                                                       const RawForm &form, bool resume);

} // namespace ada
