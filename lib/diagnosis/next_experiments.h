// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What to record next: captures that would tell a cause from those that this one does not tell it
// from, by how much, and in the words of the simulation, which is asked.
#pragma once

#include <vector>

#include "diagnosis/result.h"
#include "recording/capture.h"

namespace ada {

/// Of the motions that the shaft of `capture` can make, for each finding with alternatives, the
/// simplest that tells most of them apart; with channels that this capture has not where without
/// them none does. At most a few, in the order of the findings; none where nothing would help.
std::vector<Experiment> next_experiments(const Diagnosis &diagnosis, const Capture &capture);

} // namespace ada
