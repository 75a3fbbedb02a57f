// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The stored corpus of each fuzzer, read once. A file of it that a fuzzer has found to break
// something stays there.

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "parsers.h"

namespace ada::test {
namespace {

struct Fuzzer {
  const char *name;
  Outcome (*run)(std::string_view);
};

class Corpus : public testing::TestWithParam<Fuzzer> {};

TEST_P(Corpus, breaks_nothing) {
  int accepted = 0;
  for (const auto &entry : std::filesystem::directory_iterator(
           std::filesystem::path(ADA4571_TEST_CORPUS) / GetParam().name)) {
    SCOPED_TRACE(entry.path());
    std::ifstream file(entry.path(), std::ios::binary);
    const std::string input(std::istreambuf_iterator<char>(file), {});
    accepted += GetParam().run(input) == Outcome::accepted;
  }
  EXPECT_GT(accepted, 0); // a corpus of refusals only is none
}

INSTANTIATE_TEST_SUITE_P(Fuzzers, Corpus,
                         testing::Values(Fuzzer{"text_capture", parse_text_capture},
                                         Fuzzer{"sigmf_meta", parse_sigmf_meta},
                                         Fuzzer{"model_file", parse_model_file},
                                         Fuzzer{"effect_text", parse_effect_text},
                                         Fuzzer{"foreign_file", parse_foreign_file},
                                         Fuzzer{"pipeline", run_pipeline}),
                         [](const auto &test) { return test.param.name; });

} // namespace
} // namespace ada::test
