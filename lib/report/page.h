// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The sections of the report in the order in which they are read.
#pragma once

#include <string>
#include <vector>

#include "report/gallery.h"
#include "report/view.h"

namespace ada {

/// The whole page, its pictures still to be placed.
std::string page(const Diagnosis &diagnosis, const Capture &capture, const View &view,
                 Gallery &gallery);

/// budget.cpp: how much lies where, named and unnamed, beside the noise; no drawing program needed.
std::string budget_section(const Diagnosis &diagnosis, const View &view);
/// findings.cpp: all causes as a table, then each with its curve.
std::string causes_section(const Diagnosis &diagnosis, const View &view, Gallery &gallery);
/// leftovers.cpp: what has no name, largest first; the remainder; the noise.
std::string left_section(const Diagnosis &diagnosis, const View &view, Gallery &gallery);
std::string remainder_section(const Diagnosis &diagnosis, const View &view, Gallery &gallery);
std::string noise_section(const Diagnosis &diagnosis, const View &view, Gallery &gallery);
/// overview.cpp: the capture as a whole beside the models.
std::string record_section(const Diagnosis &diagnosis, const Capture &capture, const View &view,
                           Gallery &gallery);
std::string measured_section(const Diagnosis &diagnosis, const View &view, Gallery &gallery);
std::string residual_section(const Diagnosis &diagnosis, const View &view, Gallery &gallery);
std::string nested_section(const Diagnosis &diagnosis, const View &view, Gallery &gallery);
/// tables.cpp: the final model and the capture.
std::string model_section(const Diagnosis &diagnosis);
std::string capture_section(const Diagnosis &diagnosis, const Capture &capture, const View &view);

/// Everything before the header: title (plain text), style, marks; `tone` is a verdict's name.
std::string page_begin(const std::string &title, const std::string &tone);
/// A picture with a caption (HTML).
std::string figure(const std::string &picture, const std::string &caption_html);
/// Up to five small cells side by side, so that no row is half empty. `filler` (HTML) becomes a
/// cell where that helps, and follows the row otherwise.
std::string row(std::vector<std::string> cells, const std::string &filler = "");
/// The same two by two.
std::string halves(std::vector<std::string> cells, const std::string &filler);
/// Small swatches that say which colour is what; pairs of a class and words (HTML).
std::string legend(std::initializer_list<std::pair<const char *, std::string>> entries);

/// The style sheet.
extern const char *const kStyle;

} // namespace ada
