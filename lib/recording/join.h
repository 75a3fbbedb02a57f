// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <memory>
#include <span>

#include "recording/capture.h"

namespace ada {

/// Several captures of one sensor as one, in the order given, with `starts` saying where each begins.
/// Time goes on: each begins a thousand sample periods after the end of the one before, and a gap is
/// noted there. Throws Error with the place when they do not go together: another supply, another
/// number of periods a turn, other channels. One capture comes back as it is.
std::shared_ptr<const Capture> join(std::span<const std::shared_ptr<const Capture>> captures);

/// Record `k` of a joined capture, as it was but for its times.
Capture record_of(const Capture &joined, std::size_t k);

} // namespace ada
