// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// From the baseline up, one finding at a time: what each of them gains.
#pragma once

#include <vector>

#include "diagnosis/parts.h"
#include "diagnosis/search.h"

namespace ada {

struct Ladder {
  Model baseline, extended;
  std::vector<Model> models; ///< the baseline first, then the model after each finding
  std::vector<Finding> findings;
  Rung first, last;
};

/// Findings in the order of their size, each rung fitted to the training part and judged on the
/// rest.
Ladder build_ladder(const Parts &parts, const SearchResult &found);

/// Adds what a person reads: the cause in a sentence, and what would tell it from its rivals.
void put_in_words(Finding &finding);

} // namespace ada
