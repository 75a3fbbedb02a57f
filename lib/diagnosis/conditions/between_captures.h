// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// How long it was from one capture to the next nobody knows: each begins to count anew. A tone that
// both have tells it up to its period.
#pragma once

#include <optional>

#include "recording/capture.h"

namespace ada {

/// Captures whose strongest tone goes on from each to the next: every later one comes later by less
/// than its period. Nothing where there is one capture only, or no tone.
struct InStep {
  Capture capture;
  std::optional<Capture> heldout;
};
std::optional<InStep> in_step(const Capture &capture, const Capture *heldout);

} // namespace ada
