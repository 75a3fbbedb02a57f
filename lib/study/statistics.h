// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The statistics of a study, each with its source. Distributions are Boost.Math's. All of them take
// plain numbers and are deterministic.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ada::study {

/// Ranks from 1 on, ties at their mean.
std::vector<double> ranks(std::span<const double> x);

struct Significance {
  double statistic = 0.0;
  double p = 1.0; ///< two-sided
};

/// Spearman's rank correlation; p by Student's t with n - 2 degrees of freedom (Kendall & Stuart,
/// vol. 2, 31.19). `lost`: degrees of freedom that were taken off the data before.
Significance spearman(std::span<const double> x, std::span<const double> y, std::size_t lost = 0);

/// Kruskal and Wallis (1952): whether groups differ, with the correction for ties; p by the
/// chi-squared distribution.
Significance kruskal_wallis(std::span<const double> x, std::span<const std::size_t> group,
                            std::size_t groups);

/// Pearson's chi-squared of a table of counts, rows by columns.
Significance contingency(const std::vector<std::vector<double>> &counts);

/// Adjusted p values of Benjamini and Hochberg (1995): reported are those below the share of false
/// discoveries that is accepted.
std::vector<double> benjamini_hochberg(std::span<const double> p);

/// Holm (1979): the same for the chance of a single false one.
std::vector<double> holm(std::span<const double> p);

/// Share of false discoveries that is accepted.
inline constexpr double kFalseDiscoveries = 0.05;

struct Trend {
  double slope = 0.0, intercept = 0.0, std_error = 0.0;
  double p = 1.0; ///< of the slope, Student's t
};

/// A straight line by Huber's M-estimator (Huber & Ronchetti 2009, ch. 7; tuning 1.345, standard
/// error by their 7.6), which a few outliers do not turn. Nothing where x does not vary.
std::optional<Trend> robust_trend(std::span<const double> x, std::span<const double> y,
                                  std::size_t lost = 0);

struct Components {
  double between = 0.0, within = 0.0; ///< standard deviations
  std::size_t repeated = 0;           ///< sensors with several captures
};

/// One-way random effects by the analysis of variance, unbalanced (Searle, Casella & McCulloch
/// 1992, 3.6); values beyond six robust standard deviations are drawn in first, within the sensor
/// and between them. Nothing without repeats.
std::optional<Components> variance_components(std::span<const double> x,
                                              std::span<const std::size_t> sensor);

struct Population {
  double centre = 0.0, spread = 0.0, share = 0.0;
};

/// Populations of a mixture of Gaussians (EM; McLachlan & Peel 2000), one to four by the Bayesian
/// information criterion; more than one only where they stand apart (Ashman, Bird & Zepf 1994,
/// D > 2.5, and a valley between them) and where no single population that is skewed (Yeo & Johnson
/// 2000), heavy-tailed (Student) or flat describes the numbers as well.
std::vector<Population> populations(std::span<const double> x);

/// To which of them a number belongs most likely.
std::size_t population_of(double x, const std::vector<Population> &populations);

struct Distance {
  double z = 0.0; ///< standard deviations of the bulk, which it does not sway, from its middle
  double p = 1.0; ///< of one so far away, under the worse of two tails
};

/// How far each number is from the bulk, on the scale (their own, or the logarithm's) on which its
/// two sides are more alike; where chance may have made the difference, on the one where it is
/// nearer. From 60 numbers on the spread is the median absolute deviation of its own side; the tail
/// is Student's (its degrees of freedom those that the efficiency of the deviation leaves) or the
/// exponential that continues the outer fifth of the side, whichever is longer. Fewer are judged
/// one by one against all others (the generalised extreme studentised deviate, Rosner 1983), up to
/// a fifth of them far; from 30 on by the exponential through the outer fifth of the others as
/// well. Of fewer than five, none is far. `std_error`, where it is not empty, of each number: one
/// that is known worse than most (the median) counts as far less by what that adds to the spread.
/// `amounts`: the numbers cannot be negative; of few others no logarithm is taken.
std::vector<Distance> distances(std::span<const double> x, std::span<const double> std_error = {},
                                bool amounts = true);

double median(std::vector<double> x);               ///< NaN for none
double median_deviation(std::span<const double> x); ///< times 1.4826

} // namespace ada::study
