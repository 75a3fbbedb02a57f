// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Groups that nobody labelled, and the outliers: both by sensors.

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

#include "model/effect.h"
#include "study/summary.h"

namespace ada::study {

namespace {

constexpr std::size_t kLeastOfWord = 5;
constexpr double kChance = 0.01; ///< of a single false outlier in a whole study
constexpr double kRare = 0.02;   ///< share of the sensors that a rare cause has
constexpr std::size_t kLeastForRare = 20;
constexpr double kMatters = 3.0; ///< a rare cause costs so many times what is left of a capture

/// A number and its capture that lies nearest, one a sensor.
struct OfSensors {
  std::vector<double> value;
  std::vector<std::size_t> row;
};

OfSensors by_sensor(const Fleet &f, const Column &c) {
  std::map<std::size_t, std::vector<std::size_t>> places;
  for (std::size_t k = 0; k < c.capture.size(); ++k)
    places[f.sensor[c.capture[k]]].push_back(k);
  OfSensors out;
  for (const auto &[sensor, of] : places) {
    std::vector<double> values;
    for (const std::size_t k : of)
      values.push_back(c.value[k]);
    out.value.push_back(median(values));
    out.row.push_back(c.capture[*std::min_element(of.begin(), of.end(), [&](auto a, auto b) {
      return std::abs(c.value[a] - out.value.back()) < std::abs(c.value[b] - out.value.back());
    })]);
  }
  return out;
}

/// Whether the group of a sensor goes with a key. Rare words are one word.
Significance goes_with(const Factor &factor, const std::vector<std::size_t> &row,
                       const std::vector<std::size_t> &group, std::size_t groups) {
  std::vector<double> number;
  std::vector<std::size_t> of;
  std::map<std::string, std::vector<double>> table;
  for (std::size_t k = 0; k < row.size(); ++k) {
    if (factor.word[row[k]].empty())
      continue;
    number.push_back(factor.numeric ? factor.number[row[k]] : 0.0);
    of.push_back(group[k]);
    std::vector<double> &counts = table[factor.word[row[k]]];
    counts.resize(groups, 0.0);
    counts[group[k]] += 1.0;
  }
  if (factor.numeric)
    return number.size() < kLeastOfWord ? Significance{} : kruskal_wallis(number, of, groups);
  std::vector<std::vector<double>> counts;
  std::vector<double> rare(groups, 0.0);
  for (const auto &[word, c] : table) {
    double sum = 0.0;
    for (double n : c)
      sum += n;
    if (sum >= static_cast<double>(kLeastOfWord))
      counts.push_back(c);
    else
      for (std::size_t g = 0; g < groups; ++g)
        rare[g] += c[g];
  }
  counts.push_back(rare);
  return contingency(counts);
}

std::string serial_of(const Row &row) {
  return row.serial.empty() ? "the sensor of " + row.capture : "sensor " + row.serial;
}

/// The fleet's own scale of what is left when everything found is modelled.
double left_over_deg(const Fleet &f) {
  std::vector<double> left;
  for (const std::size_t row : f.done)
    if (std::isfinite(f.rows[row].extended_angle_rms_deg))
      left.push_back(f.rows[row].extended_angle_rms_deg);
  return left.empty() ? 0.0 : median(left);
}

/// The fitted parameter that is best known.
const Quantity *leading(const Row &row, const std::string &cause) {
  const Quantity *best = nullptr;
  for (const Quantity &q : row.quantities) {
    const Effect *effect = q.cause == cause ? find_effect(cause) : nullptr;
    if (effect == nullptr || !(q.std_error > 0.0))
      continue;
    for (const ParameterInfo &p : effect->info().parameters)
      if (p.name == q.parameter && p.role == Role::fitted &&
          (best == nullptr ||
           std::abs(q.value / q.std_error) > std::abs(best->value / best->std_error)))
        best = &q;
  }
  return best;
}

/// A cause that hardly any other sensor has, and that matters.
void find_rare(const Fleet &f, const std::vector<CauseSummary> &causes, std::vector<Outlier> &out) {
  const double matters = kMatters * left_over_deg(f);
  for (const CauseSummary &c : causes) {
    if (f.sensors < kLeastForRare ||
        static_cast<double>(c.sensors) > std::max(1.0, kRare * static_cast<double>(f.sensors)))
      continue;
    for (const std::size_t row : f.done)
      for (const FoundCause &found : f.rows[row].findings) {
        const Quantity *q = found.cause == c.cause ? leading(f.rows[row], c.cause) : nullptr;
        if (q == nullptr || !(found.angle_rms_deg > matters) || !(matters > 0.0))
          continue;
        Outlier o{row,
                  f.rows[row].capture,
                  f.rows[row].serial,
                  c.cause,
                  q->parameter,
                  "",
                  q->value / q->std_error,
                  q->value};
        o.sentence = fmt::format(
            "{} has {} ({} = {}{}), which costs {} deg rms in angle and which {} of {} sensors "
            "has.",
            serial_of(f.rows[row]), c.cause, q->parameter, digits(q->value),
            q->unit == "1" ? "" : " " + q->unit, digits(found.angle_rms_deg),
            c.sensors == 1 ? "none other" : std::to_string(c.sensors - 1) + " other", f.sensors);
        out.push_back(std::move(o));
      }
  }
}

} // namespace

std::vector<Grouping> find_groups(const Fleet &f) {
  std::vector<Grouping> out;
  struct Asked {
    std::size_t group, factor;
  };
  std::vector<Asked> asked;
  std::vector<double> p;
  for (std::size_t column = 0; column < f.columns.size(); ++column) {
    const Column &c = f.columns[column];
    if (!c.measured || c.parameter == "found")
      continue;
    const OfSensors s = by_sensor(f, c);
    Grouping g{c.cause, c.parameter, c.unit, column, populations(s.value), {}, std::nullopt};
    if (g.populations.size() < 2)
      continue;
    g.sizes.assign(g.populations.size(), 0);
    std::vector<std::size_t> group;
    for (double v : s.value)
      ++g.sizes[group.emplace_back(population_of(v, g.populations))];
    for (std::size_t factor = 0; factor < f.factors.size(); ++factor) {
      asked.push_back({out.size(), factor});
      p.push_back(goes_with(f.factors[factor], s.row, group, g.sizes.size()).p);
    }
    out.push_back(std::move(g));
  }
  const std::vector<double> adjusted = benjamini_hochberg(p);
  for (std::size_t k = 0; k < asked.size(); ++k) {
    std::optional<GoesWith> &best = out[asked[k].group].goes_with;
    if (!best || adjusted[k] < best->p_adjusted)
      best = GoesWith{f.factors[asked[k].factor].key, adjusted[k]};
  }
  return out;
}

std::vector<Outlier> find_outliers(const Fleet &f, const std::vector<CauseSummary> &causes) {
  std::vector<Outlier> all, out;
  std::vector<double> p;
  for (const Column &c : f.columns) {
    if (!c.measured || c.parameter == "found")
      continue;
    const OfSensors s = by_sensor(f, c);
    const std::vector<Distance> far = distances(s.value);
    for (std::size_t k = 0; k < far.size(); ++k) {
      const Row &row = f.rows[s.row[k]];
      p.push_back(far[k].p);
      all.push_back(
          {s.row[k], row.capture, row.serial, c.cause, c.parameter, "", far[k].z, s.value[k]});
      if (far[k].p < kChance)
        all.back().sentence = fmt::format(
            "{}: {} is {}{}, {:.1f} robust standard deviations {} the median {} of {} sensors.",
            serial_of(row), quantity_words(c.cause, c.parameter), digits(s.value[k]),
            c.unit == "1" ? "" : " " + c.unit, std::abs(far[k].z), far[k].z > 0 ? "above" : "below",
            digits(median(s.value)), s.value.size());
    }
  }
  const std::vector<double> adjusted = holm(p);
  for (std::size_t k = 0; k < all.size(); ++k)
    if (adjusted[k] < kChance)
      out.push_back(std::move(all[k]));
  find_rare(f, causes, out);
  std::stable_sort(out.begin(), out.end(), [](const Outlier &a, const Outlier &b) {
    return std::abs(a.z) > std::abs(b.z);
  });
  return out;
}

} // namespace ada::study
