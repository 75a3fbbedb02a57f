// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What a number goes with. The unit is the sensor: captures of one are not independent. Where a
// key changes from capture to capture of a sensor, what is left of each about its sensor's mean is
// compared instead.

#include <algorithm>
#include <cmath>
#include <map>

#include "study/summary.h"

namespace ada::study {

namespace {

constexpr std::size_t kLeastUnits = 8, kLeastOfLevel = 4, kLeastWithin = 8, kMostLevels = 50;
constexpr std::size_t kFewLevels = 12; ///< whole numbers of so few values may be names
/// Chance that a study in which nothing goes with anything lists something all the same.
constexpr double kChanceOfAny = 0.01;

/// A number and a factor, one a unit.
struct Pairs {
  std::vector<double> value, number;
  std::vector<std::uint32_t> word;
  bool within = false;
  std::size_t lost = 0; ///< degrees of freedom that the sensors' means took
};

double mean(const std::vector<double> &x) {
  double sum = 0.0;
  for (double v : x)
    sum += v;
  return sum / static_cast<double>(x.size());
}

struct OfSensor {
  std::vector<double> value, number;
  std::vector<std::uint32_t> word;
  bool varies() const {
    return std::any_of(word.begin(), word.end(),
                       [this](std::uint32_t w) { return w != word.front(); });
  }
};

Pairs pairs_of(const Fleet &f, const Column &column, const Factor &factor) {
  std::map<std::size_t, OfSensor> sensors;
  for (std::size_t k = 0; k < column.capture.size(); ++k) {
    const std::size_t row = column.capture[k];
    if (factor.word[row] == 0)
      continue;
    OfSensor &s = sensors[f.sensor[row]];
    s.value.push_back(column.value[k]);
    s.number.push_back(factor.numeric ? factor.number[row] : 0.0);
    s.word.push_back(factor.word[row]);
  }
  std::size_t freedom = 0;
  for (const auto &[id, s] : sensors)
    freedom += s.varies() ? s.value.size() - 1 : 0;
  Pairs out;
  out.within = freedom >= kLeastWithin;
  for (const auto &[id, s] : sensors) {
    if (!out.within) {
      out.value.push_back(mean(s.value));
      out.number.push_back(mean(s.number));
      out.word.push_back(s.word.front());
    } else if (s.varies()) {
      ++out.lost;
      for (std::size_t k = 0; k < s.value.size(); ++k) {
        out.value.push_back(s.value[k] - mean(s.value));
        out.number.push_back(s.number[k] - mean(s.number));
        out.word.push_back(s.word[k]);
      }
    }
  }
  out.lost = out.lost > 0 ? out.lost - 1 : 0;
  return out;
}

/// Numbers grow or fall with the key. Both a rank test and the robust line must see it: one alone
/// may owe it to ties, or to how the numbers are spread.
bool test_trend(const Pairs &p, bool ranks_only, Dependence &d) {
  if (p.value.size() < kLeastUnits + p.lost)
    return false;
  d.trend = robust_trend(p.number, p.value, p.lost);
  if (!d.trend)
    return false;
  const Significance rank = spearman(p.number, p.value, p.lost);
  d.p = ranks_only ? rank.p : std::max(rank.p, d.trend->p);
  return true;
}

bool test_levels(const Pairs &p, const Words &words, Dependence &d) {
  std::map<std::uint32_t, std::vector<double>> common;
  for (std::size_t k = 0; k < p.word.size(); ++k)
    common[p.word[k]].push_back(p.value[k]);
  std::erase_if(common, [](const auto &level) { return level.second.size() < kLeastOfLevel; });
  if (common.size() < 2 || common.size() > kMostLevels)
    return false;
  std::map<std::string, std::vector<double>> levels;
  for (auto &[word, values] : common)
    levels.emplace(words[word], std::move(values));
  std::vector<double> value;
  std::vector<std::size_t> group;
  for (const auto &[word, values] : levels) {
    for (double v : values) {
      value.push_back(v);
      group.push_back(d.levels.size());
    }
    d.levels.push_back({word, median(values), values.size()});
  }
  if (value.size() < kLeastUnits)
    return false;
  d.p = kruskal_wallis(value, group, d.levels.size()).p;
  return true;
}

bool few_whole_numbers(const Pairs &p) {
  std::vector<double> x = p.number;
  std::sort(x.begin(), x.end());
  x.erase(std::unique(x.begin(), x.end()), x.end());
  return x.size() <= kFewLevels &&
         std::all_of(x.begin(), x.end(), [](double v) { return v == std::floor(v); });
}

/// Nothing where the two cannot be held against each other.
std::optional<Dependence> test(const Fleet &f, std::size_t column, std::size_t factor) {
  const Column &c = f.columns[column];
  const Factor &k = f.factors[factor];
  Dependence d;
  d.cause = c.cause;
  d.parameter = c.parameter;
  d.on = k.key;
  d.unit = c.unit + (k.numeric ? " per " + k.key : "");
  d.column = column;
  d.factor = factor;
  const Pairs p = pairs_of(f, c, k);
  d.within_sensors = p.within;
  Dependence as_words = d;
  const bool named = k.words.size() > 1 && (!k.numeric || (!p.within && few_whole_numbers(p)));
  const bool words = named && test_levels(p, k.words, as_words);
  if (!k.numeric)
    return words ? std::optional(as_words) : std::nullopt;
  d.numeric = true;
  if (!test_trend(p, c.parameter == "found", d))
    return std::nullopt;
  if (!words)
    return d;
  Dependence &better = as_words.p < d.p ? as_words : d;
  better.p = std::min(1.0, 2.0 * better.p); // two tests, one answer
  if (!better.numeric)
    better.unit = c.unit;
  return better;
}

} // namespace

std::vector<Dependence> find_dependences(const Fleet &f, std::size_t &tests) {
  std::vector<Dependence> all;
  std::vector<double> p;
  for (std::size_t column = 0; column < f.columns.size(); ++column)
    for (std::size_t factor = 0; f.columns[column].measured && factor < f.factors.size(); ++factor)
      if (std::optional<Dependence> d = test(f, column, factor)) {
        p.push_back(d->p);
        all.push_back(std::move(*d));
      }
  tests = all.size();
  const std::vector<double> adjusted = benjamini_hochberg(p), strict = holm(p);
  std::vector<Dependence> out;
  // Where nothing is real, one false discovery is all of them: the first must be beyond doubt.
  if (std::none_of(strict.begin(), strict.end(), [](double q) { return q < kChanceOfAny; }))
    return out;
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k].p_adjusted = adjusted[k];
    if (adjusted[k] < kFalseDiscoveries)
      out.push_back(std::move(all[k]));
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Dependence &a, const Dependence &b) { return a.p < b.p; });
  return out;
}

} // namespace ada::study
