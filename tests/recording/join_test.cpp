// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "base/error.h"
#include "recording/join.h"

namespace ada::test {
namespace {

std::shared_ptr<Capture> some(std::size_t n, double first_s) {
  auto c = std::make_shared<Capture>();
  for (std::size_t i = 0; i < n; ++i) {
    c->time_s.push_back(first_s + 0.001 * static_cast<double>(i));
    c->vsin_v.push_back(static_cast<double>(n + i));
    c->vcos_v.push_back(2.5);
  }
  c->identity = std::to_string(n);
  return c;
}

TEST(Join, TimeGoesOnAndEachRecordIsFoundAgain) {
  const auto a = some(5, 10.0), b = some(7, 1.7e9);
  const std::vector<std::shared_ptr<const Capture>> both{a, b};
  const auto whole = join(both);
  ASSERT_EQ(whole->size(), 12u);
  EXPECT_EQ(whole->starts, (std::vector<std::size_t>{0, 5}));
  EXPECT_EQ(whole->gaps, (std::vector<std::size_t>{5}));
  EXPECT_EQ(whole->identity, "5+7");
  for (std::size_t i = 1; i < whole->size(); ++i)
    EXPECT_GT(whole->time_s[i], whole->time_s[i - 1]);
  // A thousand steps, and seconds of today have a resolution of a quarter of a microsecond.
  EXPECT_NEAR(whole->time_s[5] - whole->time_s[4], 1.0, 1000 * 2.4e-7);
  const Capture second = record_of(*whole, 1);
  EXPECT_EQ(second.vsin_v, b->vsin_v);
  EXPECT_TRUE(second.starts.empty());
  EXPECT_TRUE(second.gaps.empty());
}

TEST(Join, OneComesBackAsItIs) {
  const std::vector<std::shared_ptr<const Capture>> one{some(5, 0.0)};
  EXPECT_EQ(join(one), one[0]);
}

TEST(Join, RefusesWhatDoesNotGoTogether) {
  const auto refused = [](const std::function<void(Capture &)> &change) {
    const auto other = some(5, 0.0);
    change(*other);
    const std::vector<std::shared_ptr<const Capture>> both{some(5, 0.0), other};
    try {
      join(both);
    } catch (const Error &e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(refused([](Capture &) {}), "");
  EXPECT_EQ(refused([](Capture &c) { c.meta.supply_v = 3.3; }),
            "capture 2 does not go with the first one: its supply is 3.3 V, not 5 V");
  EXPECT_EQ(refused([](Capture &c) { c.meta.periods_per_turn = 1; }),
            "capture 2 does not go with the first one: it has 1 periods per turn, not 2");
  EXPECT_EQ(refused([](Capture &c) { c.reference_deg.assign(5, 0.0); }),
            "capture 2 does not go with the first one: it alone has the column reference_deg");
}

} // namespace
} // namespace ada::test
