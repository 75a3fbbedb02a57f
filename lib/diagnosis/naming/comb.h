// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Orders of the turn, or lines of the spectrum, of which there are many: one of them is no cause of
// its own, and stands out of them or does not.
#pragma once

#include <vector>

#include "diagnosis/search/data_split.h"
#include "diagnosis/search/search.h"

namespace ada {

/// One order or line of many is no cause of its own: it must stand out of what has no name.
void drop_what_is_of_a_comb(const Scene &scene, const DataSplit &all, SearchResult &found,
                            Axis axis);

/// Errors of the field's direction of several orders hide one another: what has no name is as large
/// about each as the next of them, so that none is taken first. With all of them taken out each has
/// to stand out of what is then left. `first`: the model before anything was held against what has
/// no name; `unasked`: causes whose alternatives nobody has asked for are added.
bool take_back_orders_that_stand_out(const Scene &scene, DataSplit split, const Model &first,
                                     SearchResult &found, std::vector<const Effect *> &unasked);

} // namespace ada
