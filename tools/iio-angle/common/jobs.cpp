// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "common/jobs.h"

#include "common/handles.h"

namespace cli {

void add_jobs_option(CLI::App &verb) {
  verb.add_option_function<unsigned>(
          "--jobs", [](unsigned jobs) { ada4571_set_jobs(jobs); },
          "threads to work with (default: as many as there are processors); results are the same")
      ->check(CLI::Range(1u, 1024u).description(""))
      ->type_name("N");
}

} // namespace cli
