// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What to record next: captures that would tell a cause from those that this one does not tell it
// from, by how much, and in the words of the simulation, which is asked.
#pragma once

#include <functional>
#include <vector>

#include "diagnosis/words/result.h"
#include "recording/capture.h"

namespace ada {

/// Of motions up to the speed that the shaft of `capture` has shown, for each finding with
/// alternatives, the simplest that tells most of them apart; with a channel that this capture has
/// not where without it none does. At most a few, in the order of the findings; none where nothing
/// would help. `goes_on` is called again and again, and may throw to end it.
std::vector<Experiment> next_experiments(const Diagnosis &diagnosis, const Capture &capture,
                                         const std::function<void()> &goes_on);

} // namespace ada
