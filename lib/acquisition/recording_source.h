// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A capture played back as a Source, as fast as it is read.
#pragma once

#include <memory>

#include "acquisition/source.h"
#include "recording/capture.h"

namespace ada {

/// Shares the capture. start() begins anew. Gaps that the capture marks are counted in
/// statistics().
std::unique_ptr<Source> make_recording_source(std::shared_ptr<const Capture> capture);

} // namespace ada
