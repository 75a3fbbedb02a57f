// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// One sample of every channel. The C struct is the vocabulary type on both sides of the API, so
// that blocks of frames cross it without a copy. A channel that does not exist is NaN.
#pragma once

#include <limits>

#include "ada4571.h"

namespace ada {

using Frame = ada4571_frame;

inline constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

inline Frame empty_frame() {
  return Frame{kAbsent, kAbsent, kAbsent, kAbsent, kAbsent, kAbsent};
}

} // namespace ada
