// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Writes sample pages into a folder, each with its findings beside it, for the browser's test.

#include <cmath>
#include <cstdio>
#include <fstream>

#include "base/error.h"
#include "report/report.h"
#include "report/samples.h"

namespace {

/// What nobody can name: a mean that depends on where in the turn the shaft is, and one bad sample.
ada::Capture with_left_over(ada::Capture capture) {
  for (std::size_t i = 0; i < capture.size(); ++i) {
    const double turn = capture.reference_deg[i] * 3.14159265358979 / 180.0;
    capture.vsin_v[i] +=
        0.004 * std::fabs(std::sin(1.5 * turn)) + 0.003 * std::exp(std::cos(7 * turn));
  }
  capture.vcos_v[capture.size() / 3] += 0.05;
  return capture;
}

} // namespace

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
      {"short", capture_with({}, false, 14, 0.02)},
      {"left-over", with_left_over(capture_with({"quadrature-error"}, true, 15))}};
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
