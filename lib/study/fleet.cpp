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
#include <map>
#include <set>

#include "base/angle.h"
#include "base/text.h"
#include "model/effect.h"

namespace ada::study {

namespace {

/// Length of the mean direction from which on directions count as numbers about it (0: every
/// direction alike, 1: all the same).
constexpr double kDirected = 0.7;

/// Share of the captures from which on it says something whether a cause is there.
constexpr double kCommon = 0.05;

/// Texts of a key whose words are numbers are kept up to so many: more are no names.
constexpr std::size_t kMostTexts = 1000;

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

/// Whether a number cannot be negative: an amplitude, a noise.
bool is_amount(const std::string &cause, const std::string &parameter) {
  if (!is_cause(cause))
    return parameter != "offset_sin_v" && parameter != "offset_cos_v";
  const Effect *effect = find_effect(cause);
  if (effect == nullptr)
    return false;
  for (const ParameterInfo &p : effect->info().parameters)
    if (p.name == parameter)
      return p.minimum >= 0.0;
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
using Columns = std::map<ColumnKey, Column>;

void add(Columns &columns, const Quantity &q, std::size_t row) {
  Column &c = columns[{q.cause, q.parameter}];
  if (!std::isfinite(q.value) || (!c.capture.empty() && c.capture.back() == row))
    return; // the first of several of a kind brought the most
  c.cause = q.cause;
  c.parameter = q.parameter;
  c.unit = q.unit;
  c.capture.push_back(row);
  c.value.push_back(q.value);
  c.std_error.push_back(static_cast<float>(q.std_error));
}

double noise_angle_deg(const Row &row) {
  double noise = 0.0, amplitude = 0.0;
  for (const Quantity &q : row.quantities)
    if (q.cause == kBaseline && q.parameter == "noise_rms_v")
      noise = q.value;
    else if (q.cause == kBaseline && q.parameter == "amplitude_v")
      amplitude = q.value;
  return amplitude > 0.0 && !row.signature.empty()
             ? noise / amplitude / row.signature.periods * kDegPerRad
             : 0.0;
}

/// The fitted parameter that is best known.
const Quantity *leading(const Row &row, const std::string &cause) {
  const Effect *effect = find_effect(cause);
  const Quantity *best = nullptr;
  for (const Quantity &q : row.quantities) {
    if (effect == nullptr || q.cause != cause || !(q.std_error > 0.0))
      continue;
    for (const ParameterInfo &p : effect->info().parameters)
      if (p.name == q.parameter && p.role == Role::fitted &&
          (best == nullptr ||
           std::abs(q.value / q.std_error) > std::abs(best->value / best->std_error)))
        best = &q;
  }
  return best;
}

Member member_of(const Row &row, Words &names) {
  Member out{row.capture,
             row.serial,
             row.report,
             row.reason,
             row.state == RowState::done,
             row.sound,
             row.extended_angle_rms_deg,
             noise_angle_deg(row)};
  out.findings.reserve(row.findings.size());
  for (const FoundCause &f : row.findings) {
    MemberFinding found{names.number_of(f.cause), 0, 0, f.correctable, f.angle_rms_deg, kNaN, kNaN};
    if (const Quantity *q = leading(row, f.cause)) {
      found.parameter = names.number_of(q->parameter);
      found.unit = names.number_of(q->unit);
      found.value = q->value;
      found.std_error = q->std_error;
    }
    out.findings.push_back(found);
  }
  for (const CheckLine &c : row.checks)
    if (c.state == "failed")
      out.failed_checks.push_back(names.number_of(c.check));
  out.periods = row.signature.periods;
  out.series.assign(row.signature.values.begin(), row.signature.values.end());
  return out;
}

/// Whether each capture has each cause. A cause that hardly any has, or hardly any has not, says
/// nothing.
void add_found(const Fleet &f, Columns &columns) {
  std::map<std::uint32_t, std::size_t> captures;
  std::set<std::uint32_t> here;
  for (const std::size_t row : f.done) {
    here.clear();
    for (const MemberFinding &c : f.rows[row].findings)
      if (here.insert(c.cause).second)
        ++captures[c.cause];
  }
  for (const auto &[cause, count] : captures) {
    const double share = static_cast<double>(count) / static_cast<double>(f.done.size());
    if (share < kCommon || share > 1.0 - kCommon)
      continue;
    for (const std::size_t row : f.done) {
      const std::vector<MemberFinding> &all = f.rows[row].findings;
      const bool has =
          std::any_of(all.begin(), all.end(), [c = cause](auto &g) { return g.cause == c; });
      add(columns, {0, f.names[cause], "found", "1", has ? 1.0 : 0.0, kNaN}, row);
    }
  }
}

/// Words that are numbers, or dates (then hours since the first), become numbers, all or none.
void make_numeric(Factor &factor) {
  std::vector<double> number(factor.words.size(), kNaN), date(number);
  std::size_t numbers = 0, dates = 0;
  double first = std::numeric_limits<double>::infinity();
  for (std::uint32_t k = 1; k < factor.words.size(); ++k) {
    number[k] = parse_number(factor.words[k]).value_or(kNaN);
    date[k] = seconds_of(factor.words[k]);
    numbers += std::isnan(number[k]) ? 0 : 1;
    dates += std::isnan(date[k]) ? 0 : 1;
    if (!std::isnan(date[k]))
      first = std::min(first, date[k]);
  }
  const std::size_t words = factor.words.size() - 1;
  factor.numeric = numbers == words || dates == words;
  if (!factor.numeric)
    return;
  if (numbers != words) {
    for (double &d : date)
      d = (d - first) / 3600.0;
    number = std::move(date);
    factor.key += "_h";
  }
  factor.number.reserve(factor.word.size());
  for (const std::uint32_t word : factor.word)
    factor.number.push_back(number[word]);
  if (words > kMostTexts)
    factor.words = Words();
}

Factor order_of(const Fleet &f) {
  std::vector<std::size_t> order(f.rows.size());
  for (std::size_t k = 0; k < order.size(); ++k)
    order[k] = k;
  std::sort(order.begin(), order.end(), [&f](std::size_t a, std::size_t b) {
    return naturally_before(f.rows[a].capture, f.rows[b].capture);
  });
  Factor out{"order", true};
  out.word.resize(order.size());
  out.number.resize(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    out.number[order[k]] = static_cast<double>(k);
    out.word[order[k]] = static_cast<std::uint32_t>(k + 1); // each its own, and none is read
  }
  return out;
}

/// Takes rows by name, one after the other.
class FleetBuilder {
public:
  explicit FleetBuilder(bool diagnosed) { fleet_.diagnosed = diagnosed; }

  void add(const Row &row) {
    if (row.state == RowState::waiting) {
      ++fleet_.waiting;
      return;
    }
    const std::size_t place = fleet_.rows.size();
    fleet_.rows.push_back(member_of(row, fleet_.names));
    std::size_t sensor = 0;
    if (row.state == RowState::done) {
      fleet_.done.push_back(place);
      sensor = sensors_.emplace(row.sensor(), sensors_.size()).first->second;
      for (const Quantity &q : row.quantities)
        study::add(q.place == 0 ? of_all_ : of_findings_, q, place);
    }
    fleet_.sensor.push_back(sensor);
    for (const auto &[key, value] : row.factors) {
      Factor &factor = factors_.try_emplace(key, Factor{key}).first->second;
      factor.word.resize(place); // rows without the key
      factor.word.push_back(factor.words.number_of(value));
    }
  }

  Fleet finish() {
    fleet_.sensors = sensors_.size();
    finish_columns();
    finish_factors();
    return std::move(fleet_);
  }

private:
  void finish_columns() {
    // A number that every capture has is not taken a second time from the findings.
    std::set<std::string> known;
    for (const auto &[key, column] : of_all_)
      known.insert(key.first);
    std::erase_if(of_findings_, [&](const auto &c) { return known.count(c.first.first) > 0; });
    of_all_.merge(of_findings_);
    add_found(fleet_, of_all_);
    for (auto &[key, column] : of_all_) {
      if (column.value.empty())
        continue;
      column.measured = !is_chosen(key.first, key.second);
      column.amount = is_amount(key.first, key.second);
      if (const double cycle = cycle_of(key.first, key.second); cycle > 0.0)
        unwrap(column, cycle);
      fleet_.columns.push_back(std::move(column));
    }
  }

  void finish_factors() {
    bool dated = false;
    for (auto &[key, factor] : factors_) {
      const bool varies = factor.words.size() > 2;
      if (!varies)
        continue;
      factor.word.resize(fleet_.rows.size());
      make_numeric(factor);
      dated = dated || factor.key != key;
      fleet_.factors.push_back(std::move(factor));
    }
    if (!dated && fleet_.rows.size() > 1)
      fleet_.factors.push_back(order_of(fleet_));
  }

  Fleet fleet_;
  std::map<std::string, std::size_t> sensors_;
  Columns of_all_, of_findings_;
  std::map<std::string, Factor> factors_;
};

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

std::uint32_t Words::number_of(const std::string &word) {
  const auto known = numbers_.find(word);
  if (known != numbers_.end())
    return known->second;
  const auto number = static_cast<std::uint32_t>(words_.size());
  numbers_.emplace(words_.emplace_back(word), number);
  return number;
}

Fleet make_fleet(std::vector<Row> rows, bool diagnosed) {
  std::sort(rows.begin(), rows.end(),
            [](const Row &a, const Row &b) { return a.capture < b.capture; });
  FleetBuilder fleet(diagnosed);
  for (const Row &row : rows)
    fleet.add(row);
  return fleet.finish();
}

Fleet read_fleet(const Database &database) {
  FleetBuilder fleet(database.setup().diagnose);
  database.each([&fleet](const Row &row) { fleet.add(row); });
  return fleet.finish();
}

} // namespace ada::study
