// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A tone near half the sample rate displaces every second row against the others: mains at a rate
// of twice its frequency, or a converter before a motor. As large as the pair it hides circle and
// angle, although two rows say where the pair is without it.
#pragma once

#include <optional>
#include <vector>

#include "recording/capture.h"

namespace ada {

struct Alternation {
  Capture without; ///< the capture with it taken out
  double frequency_hz, frequency_error_hz;
  double sin_v, cos_v; ///< amplitudes
  double sin_error_v, cos_error_v;
  bool opposed = false; ///< one channel goes up where the other one goes down
};

/// The alternation of a capture without a reference that is large beside its circle, steady over
/// many rows but for its size, and without which the pair draws a better one; otherwise nothing: a
/// fit finds a small one among the lines of the spectrum.
std::optional<Alternation> large_alternation(const Capture &capture);

} // namespace ada
