// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Whether what a cause is told by goes as its law says.
#pragma once

#include "diagnosis/search/data_split.h"
#include "diagnosis/search/search.h"

namespace ada {

/// Without a reference a cause that lowers the amplitude with the speed and turns the vector by it
/// is told by the amplitude alone, and the angle that it is corrected by nobody has seen: its law
/// must describe the length as well as a straight line over the speed does, which is no law of
/// anything, or something beside it.
void drop_what_a_line_describes_better(const DataSplit &split, SearchResult &found);

} // namespace ada
