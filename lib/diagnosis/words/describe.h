// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a diagnosis says of the capture, of what it leaves without a name, and of where its model
// comes from.
#pragma once

#include "diagnosis/anonymous/anonymous.h"
#include "diagnosis/residual/repetition.h"
#include "diagnosis/words/result.h"
#include "recording/capture.h"

namespace ada {

void describe_capture(const Capture &capture, const Scene &scene, Diagnosis &d);

/// A line of the budget whose part without a name is worth a word. `again`: of what goes with the
/// angle.
std::string unnamed_sentence(const BudgetLine &line, const Selection &unnamed, const Scene &scene,
                             Recurrence again);

/// Each step in time that has no name, in words: what of the pair changes there, and by how much.
std::vector<Structure> unnamed_steps(const Anonymous &unnamed, const Model &model);

Provenance provenance_of(const Capture &capture, const SplitQuality &fitted);

} // namespace ada
