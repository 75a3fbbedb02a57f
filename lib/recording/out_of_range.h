// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <string>

#include "recording/columns.h"

namespace ada {

/// What to say of a value beyond the limit of its column: "is out of range", and what it seems to
/// be.
std::string out_of_range(const Column &column, double value);

} // namespace ada
