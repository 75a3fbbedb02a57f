// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Blocks that several threads work on: in order, each once, and with one failure however they run.

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "base/parallel.h"

using namespace ada;

namespace {

class Parallel : public testing::TestWithParam<unsigned> {
protected:
  void SetUp() override { set_jobs(GetParam()); }
  void TearDown() override { set_jobs(0); }
};

TEST_P(Parallel, takes_every_block_in_order) {
  for (const std::size_t count : {0u, 1u, 2u, 3u, 1000u}) {
    std::vector<std::size_t> taken;
    in_order<std::size_t>(
        count, [](std::size_t k, std::size_t &slot) { slot = k * k; },
        [&](std::size_t k, std::size_t &slot) {
          EXPECT_EQ(slot, k * k);
          taken.push_back(k);
        });
    ASSERT_EQ(taken.size(), count);
    for (std::size_t k = 0; k < count; ++k)
      EXPECT_EQ(taken[k], k);
  }
}

/// What comes out where making fails from one block on and taking from another.
std::string failure(std::size_t making, std::size_t taking) {
  std::atomic<int> inside{0};
  try {
    in_order<int>(
        50,
        [&](std::size_t k, int &) {
          ++inside;
          const bool fails = k >= making;
          --inside;
          if (fails)
            throw std::runtime_error("make " + std::to_string(k));
        },
        [&](std::size_t k, int &) {
          if (k >= taking)
            throw std::runtime_error("take " + std::to_string(k));
        });
  } catch (const std::runtime_error &e) {
    EXPECT_EQ(inside, 0); // nobody works on
    return e.what();
  }
  return {};
}

TEST_P(Parallel, fails_by_the_earliest_block_whatever_the_threads_do) {
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(failure(7, 50), "make 7");
    EXPECT_EQ(failure(50, 7), "take 7");
    EXPECT_EQ(failure(8, 6), "take 6");
    EXPECT_EQ(failure(6, 6), "make 6");
  }
}

/// Loops one after another and within one another, and one that fails, by the helpers of one scope.
TEST_P(Parallel, helps_all_loops_of_a_scope_with_no_more_threads_than_jobs) {
  std::mutex mutex;
  std::set<std::thread::id> threads;
  const Helpers helpers;
  for (int loop = 0; loop < 200; ++loop) {
    std::vector<std::size_t> sums(20);
    for_each_block<int>(sums.size(), [&](std::size_t outer, int &) {
      const Helpers within; // the same
      in_order<std::size_t>(
          10, [&](std::size_t k, std::size_t &slot) { slot = outer + k; },
          [&](std::size_t, std::size_t &slot) { sums[outer] += slot; });
      const std::lock_guard lock(mutex);
      threads.insert(std::this_thread::get_id());
    });
    for (std::size_t outer = 0; outer < sums.size(); ++outer)
      ASSERT_EQ(sums[outer], 10 * outer + 45);
    EXPECT_EQ(failure(7, 50), "make 7");
  }
  EXPECT_LE(threads.size(), GetParam());
}

INSTANTIATE_TEST_SUITE_P(Jobs, Parallel, testing::Values(1u, 2u, 7u));

} // namespace
