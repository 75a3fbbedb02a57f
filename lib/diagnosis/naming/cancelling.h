// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Causes that turn the vector and take it back among them, and what the direction alone tells.
#pragma once

#include <optional>

#include "diagnosis/search/data_split.h"
#include "diagnosis/search/search.h"

namespace ada {

/// Where nothing but noise is left across the vector, a length that wanders with the magnet's
/// distance or the light hides what every pair has from a fit to both, and the angle alone tells
/// it. The model by the angle alone; nothing where it tells nothing.
std::optional<Model> name_what_the_direction_tells(const DataSplit &split, SearchResult &found,
                                                   bool bent = false);

/// Causes that turn the vector to and fro and take it back among them stand for something that
/// turns it hardly at all: of their sum any length is made, as of any other set of shapes. Causes
/// that are independent turn it together by about as much as each for itself.
void drop_what_cancels(const Scene &scene, const DataSplit &split, SearchResult &found);

/// A length that goes with the angle for no reason of the pair's, as under a gain control, bends a
/// fit to both, and further causes of the angle take back what that turned. Where the length is not
/// explained with them either, and the direction by itself needs none of them beside what every
/// pair has, which turns the vector by much less than all of them that cancel each other, there are
/// none.
void drop_what_turns_back(const DataSplit &split, SearchResult &found);

} // namespace ada
