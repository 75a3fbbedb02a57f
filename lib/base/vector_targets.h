// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A correction of Highway's view of the processor. No Highway type stands in this header.
#pragma once

#include <cstdint>

namespace ada {

/// What Highway's SetSupportedTargetsForTest() is told when this library is loaded; 0: nothing, it
/// finds out by itself.
std::int64_t told_targets();

} // namespace ada
