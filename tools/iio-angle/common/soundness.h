// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <string>

#include "common/handles.h"

namespace cli {

/// Standard error, where a capture is not sound: a result can be exact and its capture odd all the
/// same, a wrong supply, say.
void warn_of_faults(const Recording &capture, const std::string &path);

} // namespace cli
