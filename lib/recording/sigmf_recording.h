// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <memory>
#include <span>
#include <string>

#include "base/mapped_file.h"
#include "recording/recording.h"
#include "recording/sigmf_meta.h"

namespace ada {

/// The samples of a data file as a recording, checked. `shown` names the data file in messages,
/// Error(ADA4571_ERROR_FORMAT), with the sample. `data` must live as long as the recording:
/// `owner`, if any, is kept with it.
std::shared_ptr<const Recording> sigmf_recording(const SigmfMeta &meta,
                                                 std::span<const std::byte> data,
                                                 const std::string &shown,
                                                 std::unique_ptr<MappedFile> owner = nullptr);

} // namespace ada
