// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "study/fleet.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <complex>
#include <cstdio>
#include <ctime>
#include <limits>
#include <set>

#include "base/angle.h"
#include "base/text.h"
#include "model/effect.h"

namespace ada::study {

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Length of the mean direction from which on directions count as numbers about it (0: every
/// direction alike, 1: all the same).
constexpr double kDirected = 0.7;

/// After how much a parameter is the same again, 0: never.
double cycle_of(const std::string &cause, const std::string &parameter) {
  if (parameter == "direction_deg") {
    const Effect *effect = find_effect(cause);
    return 360.0 / (effect != nullptr ? effect->multiplicity() : 1.0);
  }
  return parameter == "phase_deg" ? 360.0 : 0.0;
}

bool is_chosen(const std::string &cause, const std::string &parameter) {
  const Effect *effect = find_effect(cause);
  if (effect == nullptr)
    return false;
  for (const ParameterInfo &p : effect->info().parameters)
    if (p.name == parameter)
      return p.role == Role::chosen || p.unit == "channel";
  return false;
}

/// Turns a direction so that the cut lies opposite to where most of them point.
void unwrap(Column &column, double cycle) {
  std::complex<double> sum = 0.0;
  for (double v : column.value)
    sum += std::polar(1.0, v / cycle * kTwoPi);
  const double middle = std::arg(sum) / kTwoPi * cycle;
  for (double &v : column.value)
    v = middle + wrap_centred(v - middle, cycle);
  column.measured = std::abs(sum) >= kDirected * static_cast<double>(column.value.size());
}

using ColumnKey = std::pair<std::string, std::string>;

void add(std::map<ColumnKey, Column> &columns, const Quantity &q, std::size_t row) {
  Column &c = columns[{q.cause, q.parameter}];
  if (!std::isfinite(q.value) || (!c.capture.empty() && c.capture.back() == row))
    return; // the first of several of a kind brought the most
  c.cause = q.cause;
  c.parameter = q.parameter;
  c.unit = q.unit;
  c.capture.push_back(row);
  c.value.push_back(q.value);
}

void make_columns(Fleet &f) {
  std::set<std::string> of_all, found;
  for (const std::size_t row : f.done) {
    for (const Quantity &q : f.rows[row].quantities)
      if (q.place == 0)
        of_all.insert(q.cause);
    for (const FoundCause &c : f.rows[row].findings)
      found.insert(c.cause);
  }
  std::map<ColumnKey, Column> columns;
  for (const std::size_t row : f.done) {
    for (const Quantity &q : f.rows[row].quantities)
      if (q.place == 0 || of_all.count(q.cause) == 0)
        add(columns, q, row);
    std::set<std::string> here;
    for (const FoundCause &c : f.rows[row].findings)
      here.insert(c.cause);
    for (const std::string &cause : found)
      add(columns, {0, cause, "found", "1", here.count(cause) > 0 ? 1.0 : 0.0, kNaN}, row);
  }
  for (auto &[key, column] : columns) {
    if (column.value.empty())
      continue;
    column.measured = !is_chosen(key.first, key.second);
    if (const double cycle = cycle_of(key.first, key.second); cycle > 0.0)
      unwrap(column, cycle);
    f.columns.push_back(std::move(column));
  }
}

/// Words that are numbers, or dates (then hours since the first), become numbers, all or none.
void make_numeric(Factor &factor) {
  std::vector<double> as_number, as_date;
  std::size_t words = 0, numbers = 0, dates = 0;
  double first = std::numeric_limits<double>::infinity();
  for (const std::string &word : factor.word) {
    as_number.push_back(parse_number(word).value_or(kNaN));
    as_date.push_back(seconds_of(word));
    words += word.empty() ? 0 : 1;
    numbers += std::isnan(as_number.back()) ? 0 : 1;
    dates += std::isnan(as_date.back()) ? 0 : 1;
    if (!std::isnan(as_date.back()))
      first = std::min(first, as_date.back());
  }
  if (numbers == words) {
    factor.numeric = true;
    factor.number = std::move(as_number);
  } else if (dates == words) {
    factor.numeric = true;
    for (double &d : as_date)
      d = (d - first) / 3600.0;
    factor.number = std::move(as_date);
    factor.key += "_h";
  }
}

bool varies(const Factor &factor) {
  const std::string *first = nullptr;
  for (const std::string &word : factor.word)
    if (!word.empty()) {
      if (first != nullptr && word != *first)
        return true;
      first = &word;
    }
  return false;
}

Factor order_of(const Fleet &f) {
  std::vector<std::size_t> order(f.rows.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    order[k] = k;
  std::sort(order.begin(), order.end(), [&f](std::size_t a, std::size_t b) {
    return naturally_before(f.rows[a].capture, f.rows[b].capture);
  });
  Factor out{"order", true, std::vector<std::string>(order.size()),
             std::vector<double>(order.size())};
  for (std::size_t k = 0; k < order.size(); ++k) {
    out.number[order[k]] = static_cast<double>(k);
    out.word[order[k]] = std::to_string(k);
  }
  return out;
}

void make_factors(Fleet &f) {
  std::map<std::string, Factor> factors;
  for (std::size_t row = 0; row < f.rows.size(); ++row)
    for (const auto &[key, value] : f.rows[row].factors) {
      Factor &factor = factors[key];
      factor.word.resize(f.rows.size());
      factor.word[row] = value;
    }
  bool dated = false;
  for (auto &[key, factor] : factors) {
    factor.key = key;
    if (!varies(factor))
      continue;
    make_numeric(factor);
    dated = dated || factor.key != key;
    f.factors.push_back(std::move(factor));
  }
  if (!dated && f.rows.size() > 1)
    f.factors.push_back(order_of(f));
}

} // namespace

double seconds_of(const std::string &date) {
  std::tm t{};
  int used = 0;
  const char *text = date.c_str();
  if (std::sscanf(text, "%4d-%2d-%2d%n", &t.tm_year, &t.tm_mon, &t.tm_mday, &used) != 3 || used < 8)
    return kNaN;
  double seconds = 0.0;
  text += used;
  if (*text == 'T' || *text == ' ') {
    if (std::sscanf(text + 1, "%2d:%2d%n", &t.tm_hour, &t.tm_min, &used) != 2)
      return kNaN;
    text += 1 + used;
    if (*text == ':' && std::sscanf(text, ":%lf%n", &seconds, &used) == 1)
      text += used;
  }
  if (*text != '\0' && *text != 'Z' && *text != '+' && *text != '-')
    return kNaN;
  t.tm_year -= 1900;
  t.tm_mon -= 1;
  return static_cast<double>(timegm(&t)) + seconds;
}

bool naturally_before(const std::string &a, const std::string &b) {
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!digit(a[i]) || !digit(b[j])) {
      if (a[i] != b[j])
        return a[i] < b[j];
      ++i, ++j;
      continue;
    }
    const auto run = [&digit](const std::string &s, std::size_t &at) {
      while (at + 1 < s.size() && s[at] == '0' && digit(s[at + 1]))
        ++at;
      const std::size_t from = at;
      while (at < s.size() && digit(s[at]))
        ++at;
      return s.substr(from, at - from);
    };
    const std::string x = run(a, i), y = run(b, j);
    if (x != y)
      return x.size() != y.size() ? x.size() < y.size() : x < y;
  }
  return a.size() - i != b.size() - j ? a.size() - i < b.size() - j : a < b;
}

Fleet make_fleet(std::vector<Row> rows, bool diagnosed) {
  Fleet f;
  f.diagnosed = diagnosed;
  std::sort(rows.begin(), rows.end(),
            [](const Row &a, const Row &b) { return a.capture < b.capture; });
  std::map<std::string, std::size_t> sensors;
  for (Row &row : rows) {
    if (row.state == RowState::waiting) {
      ++f.waiting;
      continue;
    }
    if (row.state == RowState::done) {
      f.done.push_back(f.rows.size());
      sensors.emplace(row.sensor(), sensors.size());
    }
    f.sensor.push_back(row.state == RowState::done ? sensors.at(row.sensor()) : 0);
    f.rows.push_back(std::move(row));
  }
  f.sensors = sensors.size();
  make_columns(f);
  make_factors(f);
  return f;
}

Fleet read_fleet(const Database &database) {
  std::vector<Row> rows;
  database.each([&rows](const Row &row) { rows.push_back(row); });
  return make_fleet(std::move(rows), database.setup().diagnose);
}

} // namespace ada::study
