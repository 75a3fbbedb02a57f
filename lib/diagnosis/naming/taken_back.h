// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Causes that were given up in favour of what has no name, and come back.
#pragma once

#include <vector>

#include "diagnosis/search/data_split.h"
#include "diagnosis/search/search.h"

namespace ada {

/// A cause that explains most of what is left without it is a finding although what has no name
/// could stand for it: many free columns follow a capture into corners that one cause does not
/// have. So are two that explain most of it together and neither by itself, as they cancel each
/// other in part.
/// `first`: the model before anything was held against what has no name. `unasked`: causes whose
/// alternatives nobody has asked for are added, as some of them will be given up again.
bool take_back_what_explains_most(const Scene &scene, DataSplit split, const Model &first,
                                  SearchResult &found, std::vector<const Effect *> &unasked);

/// Puts causes of a fitted model, those that it has beyond `less`, to what was found.
void take_back(const DataSplit &split, const Model &less, FitResult fitted, SearchResult &found,
               std::vector<const Effect *> &unasked);

/// Asks for the alternatives of those that are still there.
void ask_for_rivals(const Scene &scene, const Scene &judge, DataSplit split, SearchResult &found,
                    const std::vector<const Effect *> &unasked);

} // namespace ada
