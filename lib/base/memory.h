// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

namespace ada {

/// Bytes of memory that this machine has and this process may have (RLIMIT_AS), whatever is less.
double memory_bytes() noexcept;

} // namespace ada
