// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Recordings of many blocks: the same whatever reads them, and faults are named in their place.

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/parallel.h"
#include "captures.h"
#include "recording/identity.h"
#include "recording/recording.h"
#include "recording/spread_sample.h"
#include "support/seed.h"
#include "support/temp_folder.h"

using namespace ada;
using namespace ada::test;

namespace {

constexpr std::size_t kSamples = 100'000; ///< several blocks of either form

void expect_same(const Capture &a, const Capture &b) {
  EXPECT_EQ(a.time_s, b.time_s);
  EXPECT_EQ(a.vsin_v, b.vsin_v);
  EXPECT_EQ(a.vcos_v, b.vcos_v);
  EXPECT_EQ(a.vtemp_v, b.vtemp_v);
  EXPECT_EQ(a.gaps, b.gaps);
  EXPECT_EQ(a.identity, b.identity);
}

class Blocks : public testing::TestWithParam<const char *> {
protected:
  void SetUp() override {
    std::mt19937_64 rng(fresh_seed());
    capture_ = converter_channels_only(counted_capture(rng, kSamples, 16, 5.0, 10000.0));
    const std::size_t lost = std::uniform_int_distribution<std::size_t>(1, kSamples - 1)(rng);
    for (std::size_t i = lost; i < kSamples; ++i)
      capture_.time_s[i] += 0.25;
    path_ = folder_ / (std::string("c") + GetParam());
    write_capture(capture_, path_);
    capture_.gaps = {lost};
  }
  void TearDown() override { set_jobs(0); }

  TempFolder folder_;
  std::string path_;
  Capture capture_;
};

TEST_P(Blocks, hold_what_was_written_for_any_number_of_threads) {
  set_jobs(1);
  const auto one = open_recording(path_);
  ASSERT_GT(one->blocks(), 2u);
  EXPECT_EQ(one->size(), kSamples);
  EXPECT_EQ(one->identity(), capture_identity(capture_));
  EXPECT_EQ(one->facts().gaps, capture_.gaps);
  set_jobs(5);
  const auto many = open_recording(path_);
  expect_same(*one->whole(), *many->whole());
  EXPECT_EQ(one->jumps(), many->jumps());
  EXPECT_EQ(one->whole()->vsin_v.size(), kSamples);
}

TEST_P(Blocks, are_the_recording_in_parts) {
  const auto recording = open_recording(path_);
  const Capture &whole = *recording->whole();
  Block block;
  std::size_t next = 0;
  for (std::size_t k = 0; k < recording->blocks(); ++k) {
    recording->read(k, kTimeColumn | kPairColumns, block);
    ASSERT_EQ(block.first, next);
    ASSERT_EQ(recording->block_of(block.first), k);
    EXPECT_TRUE(std::equal(block.vcos_v.begin(), block.vcos_v.end(),
                           whole.vcos_v.begin() + static_cast<std::ptrdiff_t>(next)));
    EXPECT_TRUE(block.vtemp_v.empty());
    next += block.count;
    const std::size_t middle = block.count / 2;
    const double vsin = block.vsin_v[middle];
    recording->read(k, middle, 1, kPairColumns, block);
    ASSERT_EQ(block.count, 1u);
    EXPECT_EQ(block.vsin_v[0], vsin);
  }
  EXPECT_EQ(next, recording->size());
}

TEST_P(Blocks, give_a_sample_from_everywhere) {
  const auto recording = open_recording(path_);
  const auto sample = spread_sample(*recording, 4096, 64);
  ASSERT_EQ(sample->size(), 4096u);
  ASSERT_EQ(sample->gaps.size(), 63u);
  std::set<std::size_t> parts;
  for (std::size_t i = 0; i < sample->size(); ++i) {
    const std::size_t place = sample_place(kSamples, 4096, 64, i);
    EXPECT_EQ(sample->time_s[i], recording->time_s(place));
    parts.insert(place / (kSamples / 64));
  }
  EXPECT_GE(parts.size(), 64u);
  EXPECT_EQ(spread_sample(*recording, kSamples, 64)->size(), kSamples);
}

TEST_P(Blocks, that_were_cut_off_meanwhile_are_an_error) {
  const auto recording = open_recording(path_);
  const std::string data = GetParam() == std::string(".csv") ? path_ : (folder_ / "c.sigmf-data");
  std::filesystem::resize_file(data, std::filesystem::file_size(data) / 3);
  Block block;
  const auto read_last = [&] { recording->read(recording->blocks() - 1, kAllColumns, block); };
  EXPECT_EQ(failure(read_last), data + ": the file was cut short while it was read");
  EXPECT_EQ(failure([&] { recording->whole(); }), failure(read_last));
}

/// A mapping of such a file would end the process by SIGBUS.
TEST_P(Blocks, of_a_file_that_shrinks_again_and_again_are_read_or_an_error) {
  const auto recording = open_recording(path_);
  const std::string data = GetParam() == std::string(".csv") ? path_ : (folder_ / "c.sigmf-data");
  const auto size = std::filesystem::file_size(data);
  std::atomic<bool> done = false;
  std::thread other([&] {
    for (bool short_now = true; !done; short_now = !short_now)
      std::filesystem::resize_file(data, short_now ? size / 3 : size);
  });
  std::size_t refused = 0;
  for (int round = 0; round < 1000 && refused < 100; ++round)
    for (std::size_t k = 0; k < recording->blocks(); ++k) {
      Block block;
      refused += failure([&] { recording->read(k, kAllColumns, block); }).empty() ? 0 : 1;
    }
  done = true;
  other.join();
  EXPECT_GT(refused, 0u);
}

INSTANTIATE_TEST_SUITE_P(Forms, Blocks, testing::Values(".csv", ".sigmf-meta"),
                         [](const auto &form) {
                           return std::string(form.index == 0 ? "text" : "sigmf");
                         });

/// A file of holes; nothing of it is read.
TEST(LongRecording, as_a_whole_is_refused_where_it_takes_most_of_the_memory) {
  const TempFolder folder;
  const auto memory = static_cast<std::uintmax_t>(sysconf(_SC_PHYS_PAGES)) *
                      static_cast<std::uintmax_t>(sysconf(_SC_PAGESIZE));
  const std::uintmax_t frames = memory / 32; // of three columns of doubles: three quarters of it
  std::ofstream(folder / "c.sigmf-meta")
      << R"({"global": {"core:datatype": "ru16_le", "core:version": "1.2.0", "core:num_channels": 2,)"
      << R"("core:sample_rate": 1000, "core:extensions": [{"name": "ada4571", "version": "1.0.0",)"
      << R"("optional": true}], "ada4571:channels": [{"name": "vsin_v", "unit": "V", "scale": 1e-5,)"
      << R"("offset": 0}, {"name": "vcos_v", "unit": "V", "scale": 1e-5, "offset": 0}]},)"
      << R"("captures": [{"core:sample_start": 0}], "annotations": []})";
  std::ofstream(folder / "c.sigmf-data");
  std::filesystem::resize_file(folder / "c.sigmf-data", 4 * frames);
  const auto recording = open_recording(folder / "c.sigmf-meta");
  ASSERT_EQ(recording->size(), frames);
  const std::string why = failure([&] { recording->whole(); });
  EXPECT_EQ(why.rfind("this has to hold the recording as a whole, " + std::to_string(frames), 0), 0u)
      << why;
}

/// Rows of a text capture, a fault in one of them.
class FaultyText : public testing::Test {
protected:
  std::string failing(std::size_t row, const std::string &text) {
    const std::string path = folder_ / "c.csv";
    std::ofstream file(path);
    file << "# ada4571-capture/1\ntime_s,vsin_v,vcos_v\n";
    for (std::size_t i = 0; i < kSamples; ++i)
      if (i == row)
        file << text;
      else
        file << i << ".000000,1.234567,3.456789\n";
    file.close();
    std::string message = failure([&] { open_recording(path); });
    return message.substr(std::min(path.size(), message.size()));
  }

  TempFolder folder_;
};

TEST_F(FaultyText, that_changes_while_it_is_read_is_refused) {
  failing(kSamples, "");
  const std::string path = folder_ / "c.csv";
  const auto recording = open_recording(path);
  std::fstream file(path, std::ios::in | std::ios::out);
  file.seekp(-20'000, std::ios::end); // within the last block
  file << std::string(20'000, ' ');
  file.close();
  Block block;
  EXPECT_EQ(failure([&] { recording->read(recording->blocks() - 1, kAllColumns, block); }),
            path + ": the file changes while it is read");
}

TEST_F(FaultyText, is_refused_with_its_line_wherever_it_is) {
  std::mt19937_64 rng(fresh_seed());
  for (int i = 0; i < 4; ++i) {
    const std::size_t row = std::uniform_int_distribution<std::size_t>(1, kSamples - 2)(rng);
    const std::string line = ":" + std::to_string(row + 3) + ":";
    const std::string time = std::to_string(row) + ".5";
    EXPECT_EQ(failing(row, time + ",x,1\n"),
              line + std::to_string(time.size() + 2) + ": vsin_v is not a number: 'x'");
    EXPECT_EQ(failing(row, "0.5,1,1\n").rfind(row > 1 ? line + "1: time_s goes back" : "", 0), 0u);
    EXPECT_EQ(failing(row, "\n").rfind(":" + std::to_string(row + 4) + ":1: rows go on", 0), 0u);
  }
}

} // namespace
