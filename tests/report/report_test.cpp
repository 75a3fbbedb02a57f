// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "report/report.h"

#include <cstdlib>
#include <gtest/gtest.h>

#include "base/error.h"
#include "report/samples.h"
#include "support/seed.h"
#include "support/temp_folder.h"

namespace ada {
namespace {

constexpr const char *kEvil = "<script>alert(1)</script>\"'&\n`touch x`";

std::size_t count(const std::string &text, const std::string &what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + what.size()))
    ++n;
  return n;
}

class Report : public ::testing::Test {
protected:
  std::string page(const Capture &capture, const Diagnosis &diagnosis) {
    const std::string path = folder_ / "report.html";
    write_report(diagnosis, capture, path);
    EXPECT_EQ(folder_.names(), std::vector<std::string>{"report.html"});
    return test::read_file(path);
  }
  test::TempFolder folder_;
};

TEST_F(Report, ShowsEveryFindingOnABoundedPage) {
  const Capture capture =
      test::capture_with({"amplitude-mismatch:k=0.02", "stray-field:b=0.01",
                          "offset-temperature-drift", "quadrature-error", "channel-skew"},
                         true, test::fresh_seed());
  const Diagnosis d = diagnose(capture, {});
  ASSERT_GE(d.findings.size(), 3u);
  const std::string text = page(capture, d);
  EXPECT_LT(text.size(), 1500000u);
  for (std::size_t i = 0; i < d.findings.size(); ++i)
    EXPECT_NE(text.find("id=\"finding-" + std::to_string(i + 1) + "\" data-cause=\"" +
                        std::string(d.findings[i].effect->info().id)),
              text.npos);
  EXPECT_EQ(count(text, "<svg"), count(text, "</svg>"));
  EXPECT_EQ(count(text, "<svg") - 1, count(text, "role=\"img\" aria-label=\""));
  EXPECT_EQ(text.find('\x01'), text.npos);
}

TEST_F(Report, NeedsNothingFromOutside) {
  const Capture capture = test::capture_with({"amplitude-mismatch:k=0.02"}, false, 1);
  const std::string text = page(capture, diagnose(capture, {}));
  EXPECT_EQ(text.find("http:"), text.npos);
  EXPECT_EQ(text.find("https:"), text.npos);
  EXPECT_EQ(text.find("url("), text.npos);
  EXPECT_EQ(text.find("src="), text.npos);
  EXPECT_EQ(text.find("<script"), text.npos);
  EXPECT_EQ(text.find("rgb("), text.npos) << "a colour that the style sheet does not rule";
}

TEST_F(Report, TextOfTheCaptureStaysText) {
  Capture capture = test::capture_with({"amplitude-mismatch:k=0.02"}, true, 2);
  capture.meta.serial = kEvil;
  capture.meta.origin = kEvil;
  DiagnosisOptions options;
  options.baseline_name = kEvil;
  const std::string text = page(capture, diagnose(capture, options));
  EXPECT_EQ(text.find("<script"), text.npos);
  EXPECT_GE(count(text, "&lt;script&gt;alert(1)&lt;/script&gt;"), 3u);
}

TEST_F(Report, TooLittleDataStillMakesAPage) {
  for (double duration_s : {0.0002, 0.01, 0.05}) {
    const Capture capture = test::capture_with({}, false, 3, duration_s);
    const Diagnosis d = diagnose(capture, {});
    const bool said = page(capture, d).find("Not enough data: ") != std::string::npos;
    EXPECT_EQ(said, d.verdict == Verdict::insufficient_data) << duration_s;
    if (duration_s < 0.001) {
      EXPECT_TRUE(said);
    }
  }
}

TEST_F(Report, LeavesTheOldPageWhenGnuplotIsMissing) {
  const std::string path = folder_ / "report.html", search = std::getenv("PATH");
  test::write_file(path, "old");
  const Capture capture = test::capture_with({"amplitude-mismatch:k=0.02"}, false, 4);
  const Diagnosis d = diagnose(capture, {});
  ::setenv("PATH", (folder_ / "nothing").c_str(), 1);
  try {
    write_report(d, capture, path);
    ADD_FAILURE() << "a report without plots";
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), ADA4571_ERROR_NOT_FOUND);
  }
  ::setenv("PATH", search.c_str(), 1);
  EXPECT_EQ(test::read_file(path), "old");
  EXPECT_EQ(folder_.names(), std::vector<std::string>{"report.html"});
}

} // namespace
} // namespace ada
