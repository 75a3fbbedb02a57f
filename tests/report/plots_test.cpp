// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// A page whose plots fail: each costs only itself, and the page says why.

#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>

#include "report/count.h"
#include "report/report.h"
#include "report/samples.h"
#include "support/temp_folder.h"

namespace ada {
namespace {

/// Puts a program of our own in place of gnuplot while it lives.
class FakeGnuplot {
public:
  /// `script`: for /bin/sh; $REAL is the true gnuplot, $N the number of this call, from 1.
  explicit FakeGnuplot(const std::string &script) : path_(std::getenv("PATH")) {
    const std::string fake = folder_ / "gnuplot", calls = folder_ / "calls";
    test::write_file(fake, "#!/bin/sh\nREAL=" + real() + "\necho >>'" + calls + "'\nN=$(wc -l <'" +
                               calls + "')\n" + script + "\n");
    std::filesystem::permissions(fake, std::filesystem::perms::owner_all);
    ::setenv("PATH", ((folder_ / "") + ":" + path_).c_str(), 1);
  }
  ~FakeGnuplot() { ::setenv("PATH", path_.c_str(), 1); }

private:
  std::string real() const {
    for (std::size_t at = 0; at <= path_.size();) {
      const std::size_t end = std::min(path_.find(':', at), path_.size());
      const std::string candidate = path_.substr(at, end - at) + "/gnuplot";
      if (std::filesystem::exists(candidate))
        return candidate;
      at = end + 1;
    }
    return "/no/gnuplot";
  }
  std::string path_;
  test::TempFolder folder_;
};

class Plots : public ::testing::Test {
protected:
  static void SetUpTestSuite() {
    capture_ = new Capture(test::capture_with({"amplitude-mismatch:k=0.02"}, true, 21, 2.0));
    diagnosis_ = new Diagnosis(diagnose(*capture_, {}));
  }
  static void TearDownTestSuite() {
    delete diagnosis_;
    delete capture_;
  }
  static std::string page() {
    test::TempFolder folder;
    write_report(*diagnosis_, *capture_, folder / "report.html");
    return test::read_file(folder / "report.html");
  }
  static std::size_t drawn(const std::string &text) { return count(text, "role=\"img\""); }
  static std::size_t undrawn(const std::string &text) { return count(text, "class=\"undrawn\""); }

  static inline const Capture *capture_ = nullptr;
  static inline const Diagnosis *diagnosis_ = nullptr;
};

TEST_F(Plots, OneThatFailsCostsOnlyItself) {
  const std::string whole = page();
  ASSERT_GT(drawn(whole), 5u);
  EXPECT_EQ(undrawn(whole), 0u);
  EXPECT_EQ(whole.find("id=\"plots-missing\""), whole.npos);
  // The first call is for all pictures, the others are for one each.
  const FakeGnuplot fake("[ $N != 1 ] && [ $N != 4 ] && exec $REAL \"$@\"\n"
                         "echo 'line 7: <no> such thing' >&2; exit 1");
  const std::string text = page();
  EXPECT_EQ(undrawn(text), 1u);
  EXPECT_EQ(drawn(text), drawn(whole) - 1);
  EXPECT_NE(text.find("line 7: &lt;no&gt; such thing"), text.npos);
  EXPECT_NE(text.find("1 of " + std::to_string(drawn(whole)) + " plots could not be drawn"),
            text.npos);
}

TEST_F(Plots, NoneIsLostToOneBadRunOfAll) {
  const std::string whole = page();
  const FakeGnuplot fake("[ $N != 1 ] && exec $REAL \"$@\"\nkill -9 $$");
  EXPECT_EQ(page(), whole);
}

TEST_F(Plots, NonsenseInPlaceOfADrawingIsNotShown) {
  for (const char *script :
       {"exit 1", "echo nonsense", "yes '<svg></svg>' | head -100",
        "echo '<svg viewBox=\"0 0 1 1\">'", "echo '<svg viewBox=\"\"></svg>'"}) {
    const FakeGnuplot fake(script);
    const std::string text = page();
    EXPECT_EQ(drawn(text), 0u) << script;
    EXPECT_GT(undrawn(text), 5u) << script;
    EXPECT_NE(text.find("This page has no plots"), text.npos) << script;
    EXPECT_NE(text.find("id=\"budget\""), text.npos) << script;
  }
}

TEST_F(Plots, ThePageIsThereWithoutGnuplot) {
  const std::string path = std::getenv("PATH");
  test::TempFolder nothing;
  ::setenv("PATH", (nothing / "").c_str(), 1);
  const std::string text = page();
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(drawn(text), 0u);
  EXPECT_NE(text.find("gnuplot-nox"), text.npos);
  for (const char *part :
       {"id=\"verdict\"", "id=\"budget\"", "id=\"causes\"", "id=\"model\"", "</html>"})
    EXPECT_NE(text.find(part), text.npos) << part;
  // What a picture would have shown is said in words, and the reason once.
  EXPECT_EQ(count(text, "It would show: "), undrawn(text));
  EXPECT_EQ(count(text, "gnuplot-nox"), 1u);
}

} // namespace
} // namespace ada
