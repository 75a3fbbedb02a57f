// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The parsers of foreign text, each as one function of bytes. A refusal (ada::Error) is an
// ordinary end; any other exception, and a result that breaks a promise, ends the process.
#pragma once

#include <string_view>

namespace ada::test {

/// What became of the input.
enum class Outcome { refused, accepted };

Outcome parse_text_capture(std::string_view input);
Outcome parse_sigmf_meta(std::string_view input);
Outcome parse_model_file(std::string_view input);
Outcome parse_effect_text(std::string_view input);

} // namespace ada::test
