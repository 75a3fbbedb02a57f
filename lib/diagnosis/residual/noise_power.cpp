// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/residual/noise_power.h"

#include <array>

#include <fmt/format.h>

namespace ada {

void report_variance(const NoisePower &power, const Memory &memory, const std::vector<int> &bin,
                     int bins, double sigma, double least, const char *along,
                     const std::function<std::string(const std::vector<double> &)> &sentence,
                     std::vector<Structure> &out) {
  constexpr double kClear = 12.0; // standard deviations of chi square
  constexpr double kMore = 0.25;  // of the mean power
  const auto of_bins = static_cast<std::size_t>(bins);
  // About the mean of each bin: what a model misses there is no noise.
  std::array<std::vector<double>, 2> middle{std::vector<double>(of_bins),
                                            std::vector<double>(of_bins)},
      number = middle;
  const auto at = [&](std::size_t i) { return static_cast<std::size_t>(bin[i]); };
  power.each([&](std::size_t i, std::size_t part, double x) {
    middle[part][at(i)] += x;
    number[part][at(i)] += 1.0;
  });
  std::vector<double> sum(of_bins, 0.0), count = sum;
  double all = 0.0, squares = 0.0, n = 0.0;
  power.each([&](std::size_t i, std::size_t part, double x) {
    const double off = x - middle[part][at(i)] / number[part][at(i)], x2 = off * off;
    sum[at(i)] += x2;
    count[at(i)] += 1.0;
    all += x2;
    squares += x2 * x2;
    n += 1.0;
  });
  const double mean = all / n;
  // Variance of a square by its own scatter: 2 of a normal variable, more where a few values stand
  // out, which then prove less.
  const double scatter = memory.of_squares() * std::max(squares / n / (mean * mean) - 1.0, 2.0);
  double chi2 = 0.0, worst = 0.0, above = 0.0;
  for (std::size_t b = 0; b < sum.size(); ++b) {
    if (count[b] == 0.0)
      continue;
    const double ratio = sum[b] / count[b] / mean - 1.0;
    above += std::max(0.0, ratio) * count[b];
    chi2 += ratio * ratio * count[b] / scatter;
    worst = std::max(worst, ratio);
    sum[b] = 1.0 + ratio;
  }
  const double z = (chi2 - bins) / std::sqrt(2.0 * bins);
  const double rms = sigma * std::sqrt(above / n);
  if (z > kClear && worst > kMore && rms > least)
    out.push_back({along, sentence(sum), rms});
}

std::string sentence_of_times(const std::vector<double> &power) {
  return fmt::format("the noise is not constant: up to {:.2g} times its mean power",
                     *std::max_element(power.begin(), power.end()));
}

std::string sentence_of_places(const std::vector<double> &power) {
  const auto most = std::max_element(power.begin(), power.end());
  const double width = 360.0 / static_cast<double>(power.size());
  return fmt::format(
      "the noise goes with the place in the turn: up to {:.2g} times its mean power, "
      "about {:.3g} deg",
      *most, width * (static_cast<double>(most - power.begin()) + 0.5));
}

} // namespace ada
