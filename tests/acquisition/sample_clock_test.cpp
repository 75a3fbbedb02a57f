// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include "acquisition/sample_clock.h"
#include "support/seed.h"

using ada::SampleClock;

namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000'000; // realtime, now: needs all 64 bits

/// Timestamps of a device of `period_ns` whose frames in `missing` are lost, each stamp off by a
/// jitter of standard deviation `sigma` periods (at most 0.45 periods).
struct Stream {
  double period_ns = 100'000.0;
  double sigma = 0.0;
  std::set<int> missing{};

  template <class Accept> void run(int frames, std::mt19937_64 &random, Accept &&accept) const {
    std::normal_distribution<double> jitter(0.0, sigma > 0 ? sigma : 1.0);
    for (int i = 0; i < frames; ++i) {
      if (missing.count(i))
        continue;
      const double late = sigma > 0 ? std::clamp(jitter(random), -0.2, 0.2) : 0.0;
      accept(kStart + static_cast<std::int64_t>((i + late) * period_ns));
    }
  }
};

TEST(SampleClock, TimesAreSecondsSinceTheFirstFrame) {
  SampleClock clock(10000.0);
  EXPECT_EQ(clock.accept(kStart), 0.0);
  EXPECT_DOUBLE_EQ(clock.accept(kStart + 100'000), 1e-4);
  EXPECT_DOUBLE_EQ(clock.accept(kStart + 1'000'000'000), 1.0);
}

TEST(SampleClock, WithoutTimestampsTimesFollowTheRate) {
  SampleClock clock(1000.0);
  for (int i = 0; i < 5; ++i)
    EXPECT_DOUBLE_EQ(clock.accept_untimed(), i * 1e-3);
  EXPECT_EQ(clock.statistics().frames, 5u);
  EXPECT_EQ(clock.statistics().lost, 0u);
}

TEST(SampleClock, CountsEveryLostFrameExactlyWithAnyNominalRate) {
  std::mt19937_64 random(ada::test::fresh_seed());
  // Right, wrong by 3 %, unknown.
  for (const double nominal : {10000.0, 9700.0, 0.0})
    for (int trial = 0; trial < 50; ++trial) {
      Stream stream;
      stream.sigma = 0.05;
      std::uint64_t gaps = 0;
      for (int at = 100; at < 4900; at += 60 + static_cast<int>(random() % 200)) {
        const int length = 1 + static_cast<int>(random() % 20);
        for (int k = 0; k < length; ++k)
          stream.missing.insert(at + k);
        ++gaps;
      }
      SampleClock clock(nominal);
      stream.run(5000, random, [&](std::int64_t t) { clock.accept(t); });
      ASSERT_EQ(clock.statistics().frames, 5000 - stream.missing.size());
      ASSERT_EQ(clock.statistics().lost, stream.missing.size()) << nominal;
      ASSERT_EQ(clock.statistics().gaps, gaps);
    }
}

TEST(SampleClock, AHugeGapIsCountedExactly) {
  SampleClock clock(10000.0);
  for (int i = 0; i < 500; ++i)
    clock.accept(kStart + i * 100'000);
  for (int i = 0; i < 500; ++i)
    clock.accept(kStart + (i + 500 + 100'000) * std::int64_t{100'000});
  EXPECT_EQ(clock.statistics().lost, 100'000u);
  EXPECT_EQ(clock.statistics().gaps, 1u);
}

TEST(SampleClock, LossesAmongTheFirstFramesAreCountedToo) {
  SampleClock clock(10000.0);
  for (const int i : {0, 1, 2, 5, 6, 7, 8, 12, 13, 14})
    clock.accept(kStart + i * 100'000);
  EXPECT_EQ(clock.statistics().lost, 5u); // with fewer frames than the period is learned from
  EXPECT_EQ(clock.statistics().gaps, 2u);
  for (int i = 15; i < 200; ++i)
    clock.accept(kStart + i * 100'000);
  EXPECT_EQ(clock.statistics().lost, 5u);
}

TEST(SampleClock, ALateTimestampIsNoLoss) {
  SampleClock clock(10000.0);
  for (int i = 0; i < 405; ++i) {   // the last ones in time again
    const bool late = i % 50 == 49; // 1.7 and 0.3 periods
    clock.accept(kStart + i * 100'000 + (late ? 70'000 : 0));
  }
  EXPECT_EQ(clock.statistics().lost, 0u);
  EXPECT_EQ(clock.statistics().gaps, 0u);
}

TEST(SampleClock, WhenEverySecondFrameIsMissingTheNominalRateTells) {
  SampleClock clock(10000.0);
  for (int i = 0; i < 1000; ++i)
    clock.accept(kStart + i * 200'000);
  EXPECT_EQ(clock.statistics().lost, 999u);
}

TEST(SampleClock, ARateThatFitsNoMultipleIsNotBelieved) {
  SampleClock clock(10000.0);
  for (int i = 0; i < 1000; ++i)
    clock.accept(kStart + i * 137'000);
  EXPECT_EQ(clock.statistics().lost, 0u);
}

TEST(SampleClock, OneStampForAWholeHardwareFifoIsNoLoss) {
  SampleClock clock(10000.0);
  for (int i = 0; i < 1000; ++i)
    clock.accept(kStart + (i / 4) * 400'000);
  EXPECT_EQ(clock.statistics().lost, 0u);
}

TEST(SampleClock, FollowsAClockThatDriftsByOnePerCent) {
  SampleClock clock(10000.0);
  double t = 0, period = 100'000;
  for (int i = 0; i < 100'000; ++i) {
    clock.accept(kStart + static_cast<std::int64_t>(t));
    t += period;
    period *= 1.0 + 1e-7;
  }
  EXPECT_EQ(clock.statistics().lost, 0u);
  EXPECT_NEAR(clock.period_s(), period * 1e-9, period * 1e-9 * 1e-4);
}

TEST(SampleClock, AClockThatIsSetBackIsBridgedAndCountedAsAGap) {
  SampleClock clock(10000.0);
  for (int i = 0; i < 100; ++i)
    clock.accept(kStart + i * 100'000);
  double last = 99e-4;
  for (int i = 0; i < 100; ++i) {
    const double t = clock.accept(kStart - 3'600'000'000'000 + i * 100'000);
    EXPECT_NEAR(t - last, 1e-4, 1e-7);
    last = t;
  }
  EXPECT_EQ(clock.statistics().lost, 0u);
  EXPECT_EQ(clock.statistics().gaps, 1u);
}

TEST(SampleClock, ResetForgetsAllButTheRate) {
  SampleClock clock(10000.0);
  for (int i = 0; i < 100; ++i)
    clock.accept(kStart + i * 300'000);
  clock.reset();
  EXPECT_EQ(clock.statistics().frames, 0u);
  EXPECT_EQ(clock.statistics().lost, 0u);
  EXPECT_EQ(clock.accept(kStart), 0.0);
}

TEST(SampleClock, AnyTimestampsGiveFiniteTimesThatNeverGoBack) {
  std::mt19937_64 random(ada::test::fresh_seed());
  for (int trial = 0; trial < 200; ++trial) {
    SampleClock clock(trial % 2 ? 1000.0 : 0.0);
    double last = 0.0;
    for (int i = 0; i < 200; ++i) {
      const double t = clock.accept(static_cast<std::int64_t>(random()) >> (random() % 60));
      ASSERT_TRUE(std::isfinite(t));
      ASSERT_GE(t, last);
      last = t;
    }
  }
}

/// This machine's clock, as frames come at the rate of 10 kHz.
std::int64_t own_ns(int frame) {
  return 77'000'000'000 + frame * std::int64_t{100'000};
}

TEST(SampleClock, TimestampsThatStandStillGiveTimesOfTheRate) {
  for (const std::int64_t stamp : {std::int64_t{0}, kStart}) {
    SampleClock clock(10000.0);
    for (int i = 0; i < 30'000; ++i)
      ASSERT_NEAR(clock.accept(stamp, own_ns(i)), i * 1e-4, 1e-9);
    EXPECT_EQ(clock.statistics().lost, 0u);
    EXPECT_NEAR(static_cast<double>(clock.statistics().bad_times), 20'000, 1); // after a second
  }
}

TEST(SampleClock, OneStampForAWholeHardwareFifoIsSpreadOverIt) {
  SampleClock clock(10000.0);
  for (int i = 0; i < 1000; ++i)
    ASSERT_NEAR(clock.accept(kStart + (i / 4) * 400'000, own_ns(i)), i * 1e-4, 1e-9);
  EXPECT_EQ(clock.statistics().bad_times, 0u);
}

TEST(SampleClock, AClockThatIsSetToTodayCostsOneTimestamp) {
  SampleClock clock(10000.0);
  for (int i = 0; i < 2000; ++i) {
    const std::int64_t set = i < 700 ? 0 : kStart; // from 1970, as on a board without a battery
    ASSERT_NEAR(clock.accept(set + i * 100'000, own_ns(i)), i * 1e-4, 1e-6);
  }
  EXPECT_EQ(clock.statistics().lost, 0u);
  EXPECT_EQ(clock.statistics().bad_times, 1u);
}

/// A leap of seconds that no second of this machine's goes with is none, wherever it comes and
/// however the frames are delivered.
TEST(SampleClock, ALeapThatThisMachineDidNotSeeCostsOneTimestamp) {
  std::mt19937_64 random(ada::test::fresh_seed());
  for (int trial = 0; trial < 200; ++trial) {
    const std::int64_t leap = 2'100'000'000 + static_cast<std::int64_t>(random() % 58'000'000'000);
    const int frames = 40'000, at = 1 + static_cast<int>(ada::test::below(random, frames - 1));
    const int block = 1 + static_cast<int>(ada::test::below(random, 800));
    SampleClock clock(trial % 2 ? 10000.0 : 0.0, own_ns(0));
    double last = 0;
    for (int i = 0; i < frames; ++i)
      last = clock.accept(kStart + i * std::int64_t{100'000} + (i < at ? 0 : leap),
                          own_ns((i / block + 1) * block)); // as its block came
    const bool known = trial % 2 || at > static_cast<int>(SampleClock::kLearn);
    EXPECT_NEAR(last, (frames - 1) * 1e-4, known ? 1e-6 : 1e-3) << leap << " at " << at;
    EXPECT_EQ(clock.statistics().bad_times, 1u) << leap << " at " << at << ", blocks of " << block;
    EXPECT_EQ(clock.statistics().lost, 0u);
  }
}

/// What is late by as much as its first frame was, off by a tenth, or a recording that is played
/// faster than it was made, does not leap; its gaps are losses.
TEST(SampleClock, AGapOfASourceWithAnotherPaceIsALoss) {
  std::mt19937_64 random(ada::test::fresh_seed());
  for (const double pace : {0.9, 1.0, 1.1, 20.0}) {
    const double late_s =
        (pace < 2 ? 10 : 0.1) * std::uniform_real_distribution<double>(0, 1)(random);
    const auto gap = static_cast<int>(30'000 + ada::test::below(random, 300'000)); // in frames
    SampleClock clock(10000.0, own_ns(0));
    const int half = 100'000;
    for (int i = 0; i < 2 * half; ++i) {
      const int frame = i < half ? i : i + gap;
      const int of_block = frame - i % 500 + 500;
      clock.accept(kStart + frame * std::int64_t{100'000},
                   own_ns(static_cast<int>(of_block / pace + 1e4 * late_s)));
    }
    EXPECT_EQ(clock.statistics().lost, static_cast<std::uint64_t>(gap)) << pace;
    EXPECT_EQ(clock.statistics().bad_times, 0u) << pace << ", late by " << late_s;
  }
}

TEST(SampleClock, AGapAsLongAsThisMachineSawItIsALoss) {
  SampleClock clock(10000.0);
  for (int i = 0; i < 500; ++i)
    clock.accept(kStart + i * 100'000, own_ns(i));
  const int hour = 36'000'000; // in frames
  for (int i = 500; i < 1000; ++i)
    clock.accept(kStart + (i + hour) * std::int64_t{100'000}, own_ns(i + hour));
  EXPECT_EQ(clock.statistics().lost, static_cast<std::uint64_t>(hour));
  EXPECT_EQ(clock.statistics().bad_times, 0u);
}

TEST(SampleClock, NonsenseGivesTimesOfTheRateAndNoLosses) {
  std::mt19937_64 random(ada::test::fresh_seed());
  for (int trial = 0; trial < 50; ++trial) {
    SampleClock clock(10000.0);
    const auto shift = random() % 10; // leaps of days to years: one of a minute is believed
    double last = 0;
    std::uint64_t before = 0;
    for (int i = 0; i < 2000; ++i) {
      std::uint64_t stamp = random() >> shift;
      while (stamp - before < 100'000'000'000u)
        stamp = random() >> shift;
      before = stamp;
      last = clock.accept(static_cast<std::int64_t>(stamp), own_ns(i));
    }
    EXPECT_NEAR(last, 0.1999, 1e-3);
    EXPECT_EQ(clock.statistics().lost, 0u);
    EXPECT_GT(clock.statistics().bad_times, 1900u);
  }
}

/// Blocks of a stream with losses and jitter: taken at once where they are even, frame by frame
/// where not, they give the times and the losses of frame by frame.
TEST(SampleClock, EvenBlocksAtOnceCountTheSame) {
  std::mt19937_64 random(ada::test::fresh_seed());
  std::size_t at_once = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Stream stream;
    stream.sigma = trial % 3 == 0 ? 0.0 : trial % 3 == 1 ? 0.003 : 0.05;
    for (int k = 0; k < 6; ++k) {
      const int at = 200 + static_cast<int>(random() % 9000);
      for (int length = 1 + static_cast<int>(random() % 9); length > 0; --length)
        stream.missing.insert(at + length);
    }
    std::vector<std::int64_t> stamps;
    stream.run(10'000, random, [&](std::int64_t t) { stamps.push_back(t); });
    SampleClock one(10000.0), blocks(10000.0);
    for (std::size_t first = 0; first < stamps.size();) {
      const std::size_t count =
          std::min(stamps.size() - first, std::size_t{1} + ada::test::below(random, 400));
      const auto origin = blocks.accept_even(reinterpret_cast<const std::byte *>(&stamps[first]),
                                             sizeof(std::int64_t), count);
      at_once += origin ? count : 0;
      for (std::size_t i = first; i < first + count; ++i) {
        const double time = one.accept(stamps[i]);
        const double other =
            origin ? static_cast<double>(stamps[i] - *origin) * 1e-9 : blocks.accept(stamps[i]);
        ASSERT_NEAR(other, time, 1e-12);
      }
      first += count;
    }
    ASSERT_EQ(blocks.statistics().frames, one.statistics().frames);
    ASSERT_EQ(blocks.statistics().lost, stream.missing.size());
    ASSERT_EQ(blocks.statistics().lost, one.statistics().lost);
    ASSERT_EQ(blocks.statistics().gaps, one.statistics().gaps);
  }
  EXPECT_GT(at_once, 60u * 10'000u / 4);
}

TEST(SampleClock, NothingDoubtfulIsTakenAtOnce) {
  std::mt19937_64 random(ada::test::fresh_seed());
  for (int kind = 0; kind < 5; ++kind) {
    SampleClock clock(10000.0);
    for (int i = 0; i < 200; ++i)
      clock.accept(kStart + 100'000 * i);
    std::vector<std::int64_t> block;
    for (int i = 200; i < 300; ++i)
      block.push_back(kStart + 100'000 * i);
    const std::size_t at = ada::test::below(random, 98) + 1;
    if (kind == 0) // one is missing
      for (std::size_t i = at; i < block.size(); ++i)
        block[i] += 100'000;
    else if (kind == 1)
      block[at] = block[at - 1]; // shared
    else if (kind == 2)
      block[at] = std::numeric_limits<std::int64_t>::min();
    else if (kind == 3)
      block[at] = 0;
    else
      for (std::int64_t &t : block) // all late: frames are missing before the first
        t += 300'000;
    EXPECT_FALSE(clock.accept_even(reinterpret_cast<const std::byte *>(block.data()),
                                   sizeof(std::int64_t), block.size()))
        << kind;
    EXPECT_EQ(clock.statistics().frames, 200u);
  }
}

} // namespace
