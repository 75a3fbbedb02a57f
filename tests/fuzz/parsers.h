// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The parsers of foreign text, and all that is done with a capture, each as one function of bytes. A
// refusal (ada::Error) is an ordinary end; any other exception, and a result that breaks a promise,
// ends the process.
#pragma once

#include <string_view>

#include "recording/capture.h"

namespace ada::test {

/// What became of the input.
enum class Outcome { refused, accepted };

Outcome parse_text_capture(std::string_view input);
Outcome parse_sigmf_meta(std::string_view input);
Outcome parse_model_file(std::string_view input);
Outcome parse_effect_text(std::string_view input);
/// A file of another program, by what it says of itself and by columns that are told.
Outcome parse_foreign_file(std::string_view input);

/// The capture that a text is. Throws Error.
Capture capture_of_text(std::string_view input);
/// That capture, cut to its first 3,000 samples, through check, calibrate, convert and diagnose.
Outcome run_pipeline(std::string_view input);

/// Ends the process when it was not kept.
void promise(bool kept, const char *what);

} // namespace ada::test
