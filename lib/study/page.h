// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The study as one self-contained HTML page, in the style of a capture's own.
#pragma once

#include <string>

#include "report/pictures.h"
#include "study/summary.h"

namespace ada::study {

/// Whole or not at all. Links to the captures' own pages are relative where both lie in one tree.
void write_page(const Summary &summary, const Fleet &fleet, const std::string &path);

// pictures.cpp

/// How often which value occurs, with the populations where there are several.
Picture histogram_picture(const Fleet &fleet, const ParameterSummary &parameter,
                          const std::string &cause, const Grouping *grouping);
/// Values over a key: points and the line, or a column of points a word.
Picture dependence_picture(const Fleet &fleet, const Dependence &dependence);

} // namespace ada::study
