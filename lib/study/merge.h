// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <string>
#include <vector>

#include "study/database.h"

namespace ada::study {

/// Makes one study of several, whole or not at all. Rows come in the order of their names and the
/// better() one of each is kept, so that the file depends on nothing but what was analysed.
void merge(const std::vector<std::string> &parts, const std::string &path);

/// What a study lacks, a line each: shards that are not there, captures that wait.
std::string missing(const Database &study);

} // namespace ada::study
