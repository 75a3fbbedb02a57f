// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <gtest/gtest.h>

#include "base/child_process.h"
#include "base/error.h"
#include "base/gnuplot.h"
#include "support/temp_folder.h"

namespace ada {
namespace {

std::string message_of(const std::function<void()> &work, ada4571_status status) {
  try {
    work();
  } catch (const Error &e) {
    EXPECT_EQ(e.status(), status) << e.what();
    return e.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

TEST(ChildProcess, HandsTextThroughInAnySize) {
  const std::string big(3 << 20, 'x');
  const ChildResult result = run_child("cat", {}, big);
  EXPECT_EQ(result.exit_status, 0);
  EXPECT_TRUE(result.out == big);
}

TEST(ChildProcess, KeepsErrorsApart) {
  const ChildResult result = run_child("sh", {"-c", "echo out; echo err >&2; exit 3"}, "");
  EXPECT_EQ(result.exit_status, 3);
  EXPECT_EQ(result.out, "out\n");
  EXPECT_EQ(result.err, "err\n");
}

TEST(ChildProcess, EndsWhatTakesTooLong) {
  const auto begin = std::chrono::steady_clock::now();
  message_of([] { run_child("sleep", {"60"}, "", {200, 1000}); }, ADA4571_ERROR_IO);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
}

TEST(ChildProcess, EndsWhatWritesTooMuch) {
  message_of([] { run_child("yes", {}, "", {60000, 1 << 20}); }, ADA4571_ERROR_IO);
}

TEST(ChildProcess, WorksInAHostThatIgnoresItsChildren) {
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(run_child("cat", {}, "text").out, "text");
  std::signal(SIGCHLD, before);
}

TEST(Gnuplot, DrawsOneDocumentAScript) {
  const char *script = "set terminal svg\nplot sin(x)\n";
  const auto drawings = draw({script, script, script});
  ASSERT_EQ(drawings.size(), 3u);
  for (const std::string &d : drawings)
    EXPECT_EQ(d.substr(0, 4) + d.substr(d.size() - 6), "<svg</svg>");
}

TEST(Gnuplot, SaysWhatItDoesNotUnderstand) {
  const std::string why =
      message_of([] { draw({"set terminal svg\nplot sin(x) bogus\n"}); }, ADA4571_ERROR_IO);
  EXPECT_NE(why.find("bogus"), why.npos) << why;
}

TEST(Gnuplot, IsNamedWhenMissing) {
  test::TempFolder empty;
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", (empty / "").c_str(), 1);
  const std::string why = message_of([] { draw({"plot sin(x)"}); }, ADA4571_ERROR_NOT_FOUND);
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_NE(why.find("gnuplot-nox"), why.npos) << why;
}

TEST(Gnuplot, QuotedTextIsNeverCode) {
  test::TempFolder folder;
  const std::string trap = folder / "trap";
  const std::string evil = "a'; system('touch " + trap + "'); `touch " + trap + "` \"\n\\ %s";
  draw({"set terminal svg noenhanced\nset title " + gnuplot_quoted(evil) + "\nplot sin(x)\n"});
  EXPECT_TRUE(folder.names().empty());
}

} // namespace
} // namespace ada
