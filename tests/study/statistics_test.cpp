// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Each statistic against published numbers, or against what follows from its definition.

#include <algorithm>
#include <cmath>
#include <random>

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/non_central_t.hpp>
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <gtest/gtest.h>

#include "study/fleet.h"
#include "study/statistics.h"
#include "support/seed.h"

namespace ada::study {
namespace {

TEST(Statistics, RanksShareTies) {
  const std::vector<double> x = {3.0, 1.0, 3.0, 2.0};
  EXPECT_EQ(ranks(x), (std::vector<double>{3.5, 1.0, 3.5, 2.0}));
}

TEST(Statistics, MediansOfEvenAndOddCounts) {
  EXPECT_EQ(median({3.0, 1.0, 2.0}), 2.0);
  EXPECT_EQ(median({4.0, 1.0, 2.0, 3.0}), 2.5);
  EXPECT_TRUE(std::isnan(median({})));
  EXPECT_DOUBLE_EQ(median_deviation(std::vector<double>{1, 2, 3, 4, 100}), 1.4826);
}

// Hours of television and the intelligence quotient, the example of most textbooks: rho = -29/165.
TEST(Statistics, SpearmansTextbookExample) {
  const std::vector<double> x = {86, 97, 99, 100, 101, 103, 106, 110, 112, 113};
  const std::vector<double> y = {2, 20, 28, 27, 50, 29, 7, 17, 6, 12};
  const Significance t = spearman(x, y);
  EXPECT_NEAR(t.statistic, -29.0 / 165.0, 1e-12);
  EXPECT_NEAR(t.p, 0.6271883, 1e-6);
}

// By hand: rank sums 26, 32 and 62 of five each, with a tie of three nines.
TEST(Statistics, KruskalAndWallisWithTies) {
  const std::vector<double> x = {1, 3, 5, 7, 9, 2, 4, 6, 8, 10, 9, 12, 13, 14, 9};
  const std::vector<std::size_t> g = {0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2};
  const double h = 12.0 / (15.0 * 16.0) * (26.0 * 26.0 + 32.0 * 32.0 + 62.0 * 62.0) / 5.0 - 48.0;
  const double ties = 1.0 - (27.0 - 3.0) / (15.0 * 15.0 * 15.0 - 15.0);
  const Significance t = kruskal_wallis(x, g, 3);
  EXPECT_NEAR(t.statistic, h / ties, 1e-9);
  EXPECT_NEAR(t.p, std::exp(-0.5 * h / ties), 1e-12); // chi-squared of two degrees of freedom
}

TEST(Statistics, ContingencyOfIndependentCountsIsNothing) {
  EXPECT_NEAR(contingency({{10, 20}, {20, 40}}).statistic, 0.0, 1e-12);
  // 2 by 2: n (ad - bc)^2 / product of the margins
  const Significance t = contingency({{12, 5}, {3, 20}});
  EXPECT_NEAR(t.statistic, 40.0 * 225.0 * 225.0 / (17.0 * 23.0 * 15.0 * 25.0), 1e-9);
  EXPECT_NEAR(t.p, std::erfc(std::sqrt(0.5 * t.statistic)), 1e-12);
}

// The fifteen p values of Benjamini & Hochberg (1995), section 3.2: four are rejected at 0.05, and
// by Bonferroni three.
TEST(Statistics, BenjaminiAndHochbergsOwnExample) {
  const std::vector<double> p = {0.0001, 0.0004, 0.0019, 0.0095, 0.0201, 0.0278, 0.0298, 0.0344,
                                 0.0459, 0.3240, 0.4262, 0.5719, 0.6528, 0.7590, 1.0};
  const std::vector<double> q = benjamini_hochberg(p);
  EXPECT_EQ(std::count_if(q.begin(), q.end(), [](double v) { return v <= 0.05; }), 4);
  const std::vector<double> h = holm(p);
  EXPECT_EQ(std::count_if(h.begin(), h.end(), [](double v) { return v <= 0.05; }), 3);
  EXPECT_DOUBLE_EQ(q[0], 0.0015);
  EXPECT_DOUBLE_EQ(h[1], 0.0004 * 14);
}

TEST(Statistics, ARobustTrendKeepsItsLineAndItsErrorIsHonest) {
  std::mt19937_64 rng(test::fresh_seed());
  std::normal_distribution<double> normal;
  int outside = 0;
  constexpr int kTrials = 400;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> x, y;
    for (int i = 0; i < 80; ++i) {
      x.push_back(i);
      y.push_back(3.0 + 0.5 * i + normal(rng));
    }
    y[3] += 50.0; // one wild value
    const auto t = robust_trend(x, y);
    ASSERT_TRUE(t);
    outside += std::abs(t->slope - 0.5) > 1.96 * t->std_error ? 1 : 0;
  }
  // 5 % of 400 are 20, with a standard deviation of 4.4; a wild value costs some of them.
  EXPECT_LE(outside, 20 + 6 * 4.4);
  EXPECT_FALSE(robust_trend(std::vector<double>(9, 1.0), std::vector<double>(9, 2.0)));
}

// Equal repeats: the mean squares of the analysis of variance by hand.
TEST(Statistics, VarianceComponentsOfAWorkedExample) {
  const std::vector<double> x = {1.0, 3.0, 5.0, 7.0, 9.0, 11.0};
  const std::vector<std::size_t> s = {0, 0, 1, 1, 2, 2};
  const auto c = variance_components(x, s);
  ASSERT_TRUE(c);
  EXPECT_NEAR(c->within, std::sqrt(2.0), 1e-12);                 // three times 1 + 1 over three
  EXPECT_NEAR(c->between, std::sqrt((32.0 - 2.0) / 2.0), 1e-12); // 2 (16 + 0 + 16) over two
  EXPECT_EQ(c->repeated, 3u);
  EXPECT_FALSE(variance_components(x, std::vector<std::size_t>{0, 1, 2, 3, 4, 5}));
}

TEST(Statistics, PopulationsAreCountedAndNotInvented) {
  std::mt19937_64 rng(test::fresh_seed());
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> flat;
  int invented = 0, missed = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const int n = 60 + 4 * trial;
    std::vector<double> two, one, skewed, even, heavy;
    for (int i = 0; i < n; ++i) {
      two.push_back(normal(rng) + (i % 3 == 0 ? 8.0 : 0.0));
      one.push_back(normal(rng));
      skewed.push_back(std::exp(0.8 * normal(rng)));
      even.push_back(flat(rng));
      heavy.push_back(std::student_t_distribution<double>(3.0)(rng));
    }
    missed += populations(two).size() != 2 ? 1 : 0;
    for (const auto *x : {&one, &skewed, &even, &heavy})
      invented += populations(*x).size() > 1 ? 1 : 0;
  }
  EXPECT_LE(invented, 4); // of 240: one came in 29,000
  EXPECT_LE(missed, 1);   // of 60: one came in 28,000
}

TEST(Statistics, DistancesCallNothingFarInOneDistribution) {
  std::mt19937_64 rng(test::fresh_seed());
  std::normal_distribution<double> normal;
  const auto has_outlier = [](const std::vector<double> &x) {
    std::vector<double> p;
    for (const Distance &d : distances(x))
      p.push_back(d.p);
    const std::vector<double> adjusted = holm(p);
    return *std::min_element(adjusted.begin(), adjusted.end()) < 0.01 ? 1 : 0;
  };
  int symmetric = 0, skewed = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<double> x, y;
    for (int i = 0; i < 100; ++i) {
      x.push_back(normal(rng));
      y.push_back(std::exp(0.5 * normal(rng)));
    }
    symmetric += has_outlier(x);
    skewed += has_outlier(y);
  }
  // One in a hundred of 400 are 4, with a standard deviation of 2: six of them more.
  EXPECT_LE(symmetric, 16);
  EXPECT_LE(skewed, 16);
  std::vector<double> x(100);
  for (double &v : x)
    v = normal(rng);
  x[17] = 25.0;
  EXPECT_LT(distances(x)[17].p, 1e-7);
  // The same is nothing where it is known to no better than ten; and something again to one.
  std::vector<double> error(100, 0.1);
  error[17] = 10.0;
  EXPECT_GT(distances(x, error)[17].p, 1e-3);
  EXPECT_EQ(distances(x, error)[16].p, distances(x)[16].p);
  error[17] = 1.0;
  EXPECT_LT(distances(x, error)[17].p, 0.01 / 100.0); // one of a hundred that is called far
}

constexpr std::size_t kFewSensors[] = {5, 8, 12, 20};
constexpr double kChanceOfFleet = 0.01;

class FewSensors : public ::testing::Test {
protected:
  std::mt19937_64 rng{test::fresh_seed()};
  std::normal_distribution<double> normal;

  std::vector<double> fleet(std::size_t count) {
    std::vector<double> x(count);
    for (double &v : x)
      v = normal(rng);
    return x;
  }

  /// Which are far, at one false one in a hundred fleets.
  static std::vector<std::size_t> far(const std::vector<double> &x, bool amounts = false) {
    std::vector<double> p;
    for (const Distance &d : distances(x, {}, amounts))
      p.push_back(d.p);
    const std::vector<double> adjusted = holm(p);
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < x.size(); ++i)
      if (adjusted[i] < kChanceOfFleet)
        out.push_back(i);
    return out;
  }

  /// What the deleted deviate of one of `count` must pass.
  static double limit(std::size_t count) {
    const auto n = static_cast<double>(count);
    return boost::math::quantile(boost::math::students_t(n - 2.0), 1.0 - kChanceOfFleet / n / 2.0);
  }

  /// The distance in true standard deviations at which all but one in a thousand are named: neither
  /// the number nor the deviation of the others is worse than in one of two thousand.
  static double surely(std::size_t count) {
    const auto n = static_cast<double>(count);
    constexpr double kHalf = 0.0005;
    const double wide = std::sqrt(
        boost::math::quantile(boost::math::chi_squared(n - 2.0), 1.0 - kHalf) / (n - 2.0));
    const double low = boost::math::quantile(boost::math::normal(), 1.0 - kHalf);
    return (limit(count) * wide + low) * std::sqrt(n / (n - 1.0));
  }
};

// Of 8 standard deviations as many are named as the best test can: by the non-central t.
TEST_F(FewSensors, OneOutlierOfEightDeviationsAsOftenAsCanBe) {
  constexpr int kTrials = 500;
  for (const std::size_t count : kFewSensors) {
    int named = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::vector<double> x = fleet(count);
      const std::size_t odd = test::below(rng, count);
      x[odd] = trial % 2 == 0 ? 8.0 + normal(rng) : -8.0 + normal(rng);
      const std::vector<std::size_t> found = far(x);
      named += std::count(found.begin(), found.end(), odd) > 0 ? 1 : 0;
    }
    const auto n = static_cast<double>(count);
    const double power = boost::math::cdf(boost::math::complement(
        boost::math::non_central_t(n - 2.0, 8.0 / std::sqrt(n / (n - 1.0))), limit(count)));
    const double expected = kTrials * power, chance = std::sqrt(expected * (1.0 - power));
    std::printf("%zu sensors, 8 deviations: %d of %d named, %.1f expected\n", count, named, kTrials,
                expected);
    EXPECT_GE(named, expected - 5.0 * chance - 1.0) << count;
  }
}

TEST_F(FewSensors, OneOutlierFarEnoughIsNamedAndNoOther) {
  constexpr int kTrials = 300;
  for (const std::size_t count : kFewSensors) {
    const double distance = std::max(8.0, surely(count));
    int missed = 0, wrong = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::vector<double> x = fleet(count);
      const std::size_t odd = test::below(rng, count);
      x[odd] += (trial % 2 == 0 ? 1.0 : -1.0) *
                std::uniform_real_distribution<double>(distance, 3.0 * distance)(rng);
      const std::vector<std::size_t> found = far(x);
      const bool is_found = std::count(found.begin(), found.end(), odd) > 0;
      missed += is_found ? 0 : 1;
      wrong += found.size() > (is_found ? 1U : 0U) ? 1 : 0;
    }
    std::printf("%zu sensors, from %.1f deviations on: %d of %d missed, %d with another\n", count,
                distance, missed, kTrials, wrong);
    EXPECT_LE(missed, 5) << count; // of one in a thousand, 0.3: six come once in a million runs
    EXPECT_LE(wrong, 13) << count; // of one in a hundred, 3: six deviations more
  }
}

TEST_F(FewSensors, TwoOutliersDoNotHideEachOther) {
  for (const std::size_t count : {std::size_t{12}, std::size_t{20}, std::size_t{45}}) {
    std::ptrdiff_t both = 0;
    for (int trial = 0; trial < 100; ++trial) {
      std::vector<double> x = fleet(count);
      x[1] = 25.0 + normal(rng);
      x[4] = 27.0 + normal(rng);
      const std::vector<std::size_t> found = far(x);
      both +=
          std::count(found.begin(), found.end(), 1U) + std::count(found.begin(), found.end(), 4U);
    }
    EXPECT_GE(both, 198) << count;
  }
}

// At most one fleet in a hundred, be its numbers normal or their logarithms.
TEST_F(FewSensors, EmptyFleetsStayEmpty) {
  constexpr int kTrials = 1000;
  for (const std::size_t count :
       {std::size_t{5}, std::size_t{8}, std::size_t{12}, std::size_t{20}, std::size_t{45}}) {
    int of_normal = 0, of_amounts = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      std::vector<double> x = fleet(count);
      of_normal += far(x).empty() ? 0 : 1;
      for (double &v : x)
        v = std::exp(0.5 * v);
      of_amounts += far(x, true).empty() ? 0 : 1;
    }
    std::printf("%zu sensors, empty: %d and %d of %d with an outlier\n", count, of_normal,
                of_amounts, kTrials);
    // One in a hundred of 1000 are 10, with a standard deviation of 3.2: six of them more.
    EXPECT_LE(of_normal, 29) << count;
    EXPECT_LE(of_amounts, 29) << count;
  }
}

TEST_F(FewSensors, NumbersThatDoNotVaryOrAreHardlyKnown) {
  EXPECT_TRUE(far(std::vector<double>(12, 3.0)).empty());
  EXPECT_TRUE(far({1.0, 2.0, 3.0, 1e300}).empty()); // too few to say
  std::vector<double> x = fleet(20);
  x[7] = 30.0;
  EXPECT_LT(distances(x)[7].p, 1e-7);
  EXPECT_GT(distances(x)[7].z, 15.0);
  std::vector<double> error(20, 0.1);
  error[7] = 15.0;
  EXPECT_GT(distances(x, error)[7].p, 1e-3);
  x[11] = -20.0; // far itself, and no reason to call the other far
  EXPECT_GT(distances(x, error)[7].p, 1e-3);
  EXPECT_LT(distances(x, error)[11].p, 1e-5);
}

TEST(Statistics, DatesAndNamesInTheirOrder) {
  EXPECT_EQ(seconds_of("1970-01-02"), 86400.0);
  EXPECT_EQ(seconds_of("1970-01-01T01:00:30Z"), 3630.0);
  EXPECT_TRUE(std::isnan(seconds_of("batch-7")));
  EXPECT_TRUE(std::isnan(seconds_of("12.5")));
  EXPECT_TRUE(naturally_before("ring-9.csv", "ring-10.csv"));
  EXPECT_FALSE(naturally_before("ring-10.csv", "ring-9.csv"));
  EXPECT_TRUE(naturally_before("a-2", "a-02b"));
}

} // namespace
} // namespace ada::study
