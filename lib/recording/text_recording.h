// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <memory>
#include <string>

#include "recording/recording.h"

namespace ada {

/// The text form in a regular file, open from its beginning, checked and read block by block; `shown`
/// names it in messages.
std::shared_ptr<const Recording> text_recording(int fd, const std::string &shown);

} // namespace ada
