// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#pragma once

#include <CLI/CLI.hpp>

namespace cli {

/// --jobs, of the verbs that work on long recordings.
void add_jobs_option(CLI::App &verb);

} // namespace cli
