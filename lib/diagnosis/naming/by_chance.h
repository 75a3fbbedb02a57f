// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Causes that are no more than what chance would make of a structure that nobody knows.
#pragma once

#include "diagnosis/search/data_split.h"
#include "diagnosis/search/search.h"

namespace ada {

/// Of an unknown structure the nearest of the catalogue's shapes takes a part by chance. A cause
/// that takes no more than that of what is left without a name beside it, nor of the angle's error,
/// may be a part of the same: nothing bears it out. Nor does it where what goes on in time would by
/// chance have as much of the cause's course. What every pair has was there before any data.
/// What is hidden in the noise is no structure that could have a shape.
void drop_what_chance_would_take(const Scene &scene, DataSplit split, SearchResult &found);

} // namespace ada
