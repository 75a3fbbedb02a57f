// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Another program as a filter: text in, text out. No shell, no signal handler, no inherited files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace ada {

struct ChildLimits {
  int timeout_ms = 60000;
  std::size_t output_bytes = std::size_t{32} << 20; ///< of each stream
};

struct ChildResult {
  int exit_status = -1; ///< -1: ended by a signal, or not known because the host reaps children
  std::string out, err;
};

/// Runs `program` (looked for in PATH) with `input` as its standard input. Throws Error: NOT_FOUND
/// when there is no such program, IO when it takes too long, writes too much or cannot be run.
ChildResult run_child(const std::string &program, const std::vector<std::string> &arguments,
                      std::string_view input, const ChildLimits &limits = {});

} // namespace ada
