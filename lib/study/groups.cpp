// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Groups that nobody labelled, and the outliers: both by sensors.

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>

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
  std::vector<double> std_error; ///< 0 where unknown
  std::vector<std::size_t> row;
};

OfSensors by_sensor(const Fleet &f, const Column &c) {
  std::map<std::size_t, std::vector<std::size_t>> places;
  for (std::size_t k = 0; k < c.capture.size(); ++k)
    places[f.sensor[c.capture[k]]].push_back(k);
  OfSensors out;
  for (const auto &[sensor, of] : places) {
    std::vector<double> values, errors;
    for (const std::size_t k : of) {
      values.push_back(c.value[k]);
      if (std::isfinite(c.std_error[k]))
        errors.push_back(c.std_error[k]);
    }
    out.value.push_back(median(values));
    out.std_error.push_back(errors.empty() ? 0.0 : median(errors));
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
  std::map<std::uint32_t, std::vector<double>> table;
  for (std::size_t k = 0; k < row.size(); ++k) {
    if (factor.word[row[k]] == 0)
      continue;
    number.push_back(factor.numeric ? factor.number[row[k]] : 0.0);
    of.push_back(group[k]);
    if (factor.numeric)
      continue;
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

std::string serial_of(const Member &row) {
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

/// A cause that hardly any other sensor has, and that matters.
void find_rare(const Fleet &f, const std::vector<CauseSummary> &causes, std::vector<Outlier> &out) {
  const double matters = kMatters * left_over_deg(f);
  for (const CauseSummary &c : causes) {
    if (f.sensors < kLeastForRare ||
        static_cast<double>(c.sensors) > std::max(1.0, kRare * static_cast<double>(f.sensors)))
      continue;
    for (const std::size_t row : f.done)
      for (const MemberFinding &found : f.rows[row].findings) {
        if (f.names[found.cause] != c.cause || found.parameter == 0 ||
            !(found.angle_rms_deg > matters) || !(matters > 0.0))
          continue;
        const std::string &parameter = f.names[found.parameter], &unit = f.names[found.unit];
        Outlier o{row, f.rows[row].capture,           f.rows[row].serial, c.cause, parameter,
                  "",  found.value / found.std_error, found.value};
        o.sentence = fmt::format(
            "{} has {} ({} = {}{}), which costs {} deg rms in angle and which {} of {} sensors "
            "has.",
            serial_of(f.rows[row]), c.cause, parameter, digits(found.value),
            unit == "1" ? "" : " " + unit, digits(found.angle_rms_deg),
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
  struct Far {
    std::size_t column, row;
    double z, value;
  };
  std::vector<Far> all;
  std::vector<double> p;
  std::map<std::size_t, std::string> middles; // of a column: "the median 0.01 of 60 sensors"
  for (std::size_t column = 0; column < f.columns.size(); ++column) {
    const Column &c = f.columns[column];
    if (!c.measured || c.parameter == "found")
      continue;
    const OfSensors s = by_sensor(f, c);
    const std::vector<Distance> far = distances(s.value, s.std_error, c.amount);
    for (std::size_t k = 0; k < far.size(); ++k) {
      p.push_back(far[k].p);
      all.push_back({column, s.row[k], far[k].z, s.value[k]});
    }
    middles[column] =
        fmt::format("the median {} of {} sensors", digits(median(s.value)), s.value.size());
  }
  std::vector<Outlier> out;
  const std::vector<double> adjusted = holm(p);
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (!(adjusted[k] < kChance))
      continue;
    const Far &far = all[k];
    const Column &c = f.columns[far.column];
    const Member &row = f.rows[far.row];
    out.push_back({far.row, row.capture, row.serial, c.cause, c.parameter,
                   fmt::format("{}: {} is {}{}, {:.1f} robust standard deviations {} {}.",
                               serial_of(row), quantity_words(c.cause, c.parameter),
                               digits(far.value), c.unit == "1" ? "" : " " + c.unit,
                               std::abs(far.z), far.z > 0 ? "above" : "below", middles[far.column]),
                   far.z, far.value});
  }
  find_rare(f, causes, out);
  std::stable_sort(out.begin(), out.end(), [](const Outlier &a, const Outlier &b) {
    return std::abs(a.z) > std::abs(b.z);
  });
  return out;
}

} // namespace ada::study
