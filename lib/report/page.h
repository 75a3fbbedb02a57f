// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The sections of the report in the order in which they are read.
#pragma once

#include <string>

#include "report/gallery.h"
#include "report/view.h"

namespace ada {

/// The whole page, its pictures still to be placed.
std::string page(const Diagnosis &diagnosis, const Capture &capture, const View &view,
                 Gallery &gallery);

/// Each finding with its pictures.
std::string findings_section(const Diagnosis &diagnosis, const View &view, Gallery &gallery);
/// The final model and the capture as tables.
std::string model_section(const Diagnosis &diagnosis);
std::string capture_section(const Diagnosis &diagnosis, const Capture &capture, const View &view);

/// A picture with a caption (HTML); `kind` is a class of the style sheet.
std::string figure(const std::string &picture, const std::string &caption_html,
                   const std::string &kind = "");
/// Small swatches that say which colour is what; pairs of a class and words.
std::string legend(std::initializer_list<std::pair<const char *, std::string>> entries);

/// The style sheet.
extern const char *const kStyle;

} // namespace ada
