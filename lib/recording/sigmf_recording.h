// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <memory>
#include <string>

#include "base/file_bytes.h"
#include "recording/recording.h"
#include "recording/sigmf_meta.h"

namespace ada {

/// The samples of a data file as a recording, checked. `shown` names the data file in messages,
/// Error(ADA4571_ERROR_FORMAT), with the sample. Data in memory must live as long as the recording.
std::shared_ptr<const Recording> sigmf_recording(const SigmfMeta &meta, FileBytes data,
                                                 const std::string &shown);

} // namespace ada
