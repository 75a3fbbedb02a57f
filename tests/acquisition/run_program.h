// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Runs a foreign program and gives back what it wrote.
#pragma once

#include <array>
#include <cstdio>
#include <string>

#include <sys/wait.h>

namespace ada::test {

struct ProgramResult {
  int status = -1; ///< exit status, -1 when it was killed
  std::string output;
};

/// `command` by the shell; the preload of a test bed or sanitizer is not passed on.
inline ProgramResult run_program(const std::string &command) {
  ProgramResult result;
  FILE *pipe = popen(("unset LD_PRELOAD; " + command).c_str(), "r");
  if (!pipe)
    return result;
  std::array<char, 65536> buffer;
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe))
    result.output.append(buffer.data(), n);
  const int status = pclose(pipe);
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return result;
}

} // namespace ada::test
