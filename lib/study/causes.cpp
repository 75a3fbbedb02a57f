// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "study/summary.h"

namespace ada::study {

namespace {

ParameterSummary summarise_parameter(const Fleet &f, std::size_t column) {
  const Column &c = f.columns[column];
  ParameterSummary out{c.parameter,    c.unit,          column,
                       c.value.size(), median(c.value), median_deviation(c.value),
                       std::nullopt};
  std::vector<std::size_t> sensor;
  for (const std::size_t row : c.capture)
    sensor.push_back(f.sensor[row]);
  out.components = variance_components(c.value, sensor);
  return out;
}

struct Seen {
  std::set<std::size_t> captures, sensors;
  std::map<std::size_t, double> cost; ///< of a capture, squares summed
};

std::map<std::string, Seen> seen_causes(const Fleet &f) {
  std::map<std::string, Seen> out;
  for (const std::size_t row : f.done)
    for (const MemberFinding &found : f.rows[row].findings) {
      Seen &s = out[f.names[found.cause]];
      s.captures.insert(row);
      s.sensors.insert(f.sensor[row]);
      if (std::isfinite(found.angle_rms_deg))
        s.cost[row] += found.angle_rms_deg * found.angle_rms_deg;
    }
  return out;
}

} // namespace

std::vector<CauseSummary> summarise_causes(const Fleet &f, bool baseline) {
  std::map<std::string, CauseSummary> by_name;
  if (!baseline)
    for (const auto &[cause, s] : seen_causes(f)) {
      CauseSummary &c = by_name[cause];
      c.found_in = s.captures.size();
      c.sensors = s.sensors.size();
      c.share = static_cast<double>(c.found_in) / static_cast<double>(f.done.size());
      std::vector<double> cost;
      for (const auto &[row, square] : s.cost)
        cost.push_back(std::sqrt(square));
      if (!cost.empty()) {
        c.angle_rms_deg = median(cost);
        c.fleet_cost_deg = c.share * *c.angle_rms_deg;
      }
    }
  for (std::size_t column = 0; column < f.columns.size(); ++column) {
    const Column &c = f.columns[column];
    if (is_cause(c.cause) == baseline || c.parameter == "found")
      continue;
    by_name[c.cause].parameters.push_back(summarise_parameter(f, column));
  }
  std::vector<CauseSummary> out;
  for (auto &[name, c] : by_name) {
    c.cause = name;
    out.push_back(std::move(c));
  }
  std::stable_sort(out.begin(), out.end(), [](const CauseSummary &a, const CauseSummary &b) {
    return a.fleet_cost_deg > b.fleet_cost_deg;
  });
  return out;
}

Summary summarise(const Fleet &f) {
  Summary s;
  s.captures = f.rows.size();
  s.failed = f.rows.size() - f.done.size();
  s.waiting = f.waiting;
  s.sensors = f.sensors;
  s.diagnosed = f.diagnosed;
  for (const std::size_t row : f.done)
    s.unsound += f.rows[row].sound ? 0 : 1;
  s.causes = summarise_causes(f, false);
  s.baseline = summarise_causes(f, true);
  s.dependences = find_dependences(f, s.tests);
  s.groups = find_groups(f);
  s.outliers = find_outliers(f, s.causes);
  s.sufficient = find_sufficient(f, s.causes);
  return s;
}

} // namespace ada::study
