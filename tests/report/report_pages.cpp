// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Writes sample pages into a folder, each with its findings beside it, for the browser's test.

#include <cstdio>
#include <fstream>

#include "base/error.h"
#include "report/report.h"
#include "report/samples.h"

int main(int argc, char **argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: report_pages FOLDER\n");
    return 2;
  }
  using ada::test::capture_with;
  const std::pair<const char *, ada::Capture> samples[] = {
      {"effects",
       capture_with({"amplitude-mismatch:k=0.02", "stray-field:b=0.01", "offset-temperature-drift"},
                    true, 11)},
      {"clean", capture_with({}, true, 12)},
      {"no-reference", capture_with({"amplitude-mismatch:k=0.02"}, false, 13)},
      {"short", capture_with({}, false, 14, 0.02)}};
  try {
    for (const auto &[name, capture] : samples) {
      const std::string stem = std::string(argv[1]) + "/" + name;
      const ada::Diagnosis d = ada::diagnose(capture, {});
      ada::write_report(d, capture, stem + ".html");
      std::ofstream(stem + ".json") << ada::to_json(d);
    }
  } catch (const ada::Error &e) {
    std::fprintf(stderr, "report_pages: %s\n", e.what());
    return 1;
  }
}
