// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "base/file_bytes.h"
#include "recording/recording.h"
#include "recording/sigmf_meta.h"

namespace ada {

/// Opens a SigMF recording; `path` names either of its two files. The data file is read block by
/// block.
std::shared_ptr<const Recording> open_sigmf_recording(const std::string &path);

/// The meta file of that name.
SigmfMeta read_sigmf_meta(const std::string &meta_path);

/// Frames in a data file of this length. Of an unfinished one, what a crash of the machine can
/// leave at its end does not count: part of a frame, and frames that were never filled.
std::size_t whole_frames(const SigmfMeta &meta, const FileBytes &data);

/// Whether a path names a SigMF recording, by either of its files.
bool is_sigmf(std::string_view path);

/// The two files of a recording from the name of either.
std::string sigmf_meta_path(const std::string &path);
std::string sigmf_data_path(const std::string &path);

} // namespace ada
