// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/held_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <map>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// First rows of the readings of these columns, with the ends of the records and gaps among them.
std::vector<std::size_t> first_rows(const Capture &c,
                                    std::initializer_list<const std::vector<double> *> columns) {
  std::vector<char> begins(c.size(), 0);
  for (const auto *places : {&c.starts, &c.gaps})
    for (std::size_t i : *places)
      if (i < c.size())
        begins[i] = 1;
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < c.size(); ++i)
    if (i == 0 || begins[i] || std::any_of(columns.begin(), columns.end(), [&](const auto *v) {
          return (*v)[i] != (*v)[i - 1];
        }))
      out.push_back(i);
  return out;
}

/// Whether nearly all readings stand for one number of rows, or for two next to each other.
bool held_evenly(const std::vector<std::size_t> &first) {
  std::map<std::size_t, double> of_length;
  for (std::size_t k = 1; k < first.size(); ++k)
    of_length[first[k] - first[k - 1]] += 1.0;
  double most = 0.0;
  for (const auto &[length, count] : of_length) {
    const auto next = of_length.find(length + 1);
    if (length + 1 > 2 || next == of_length.end())
      most = std::max(most,
                      (length > 1 ? count : 0.0) + (next == of_length.end() ? 0.0 : next->second));
  }
  return most > criteria::kHeldEvenly * static_cast<double>(first.size() - 1);
}

/// Share of the readings in which both channels differ from the reading before.
double both_differ(const Capture &c, const std::vector<std::size_t> &first) {
  double both = 0.0;
  for (std::size_t k = 1; k < first.size(); ++k)
    both += c.vsin_v[first[k]] != c.vsin_v[first[k] - 1] &&
            c.vcos_v[first[k]] != c.vcos_v[first[k] - 1];
  return both / static_cast<double>(first.size() - 1);
}

/// Whether a reference that is held goes on by steps of many sizes: one of few lines waits for the
/// next of them, whatever the time, and its steps are alike.
bool steps_differ(const Capture &c, const std::vector<std::size_t> &first) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < first.size(); ++k)
    steps.push_back(
        std::abs(wrap_centred(c.reference_deg[first[k]] - c.reference_deg[first[k] - 1], 360.0)));
  return quantile(steps, 1.0 - criteria::kFewSteps) >
         criteria::kStepsDiffer * quantile(steps, criteria::kFewSteps);
}

/// Whether the pair goes on while the reference is held, from row to row as far as where the
/// reference changes. Of a shaft that stands while it is read both stand.
bool pair_goes_on(const Capture &c, const std::vector<std::size_t> &first) {
  std::vector<char> fresh(c.size(), 0);
  for (std::size_t i : first)
    fresh[i] = 1;
  struct {
    double way = 0.0, rows = 0.0;
    double mean() const { return way / std::max(rows, 1.0); }
  } within, between;
  for (std::size_t i = 1; i < c.size(); ++i) {
    auto &of = fresh[i] ? between : within;
    of.way += std::hypot(c.vsin_v[i] - c.vsin_v[i - 1], c.vcos_v[i] - c.vcos_v[i - 1]);
    of.rows += 1.0;
  }
  return within.mean() >= criteria::kGoesOn * between.mean();
}

bool held(const Capture &capture, const std::vector<std::size_t> &first) {
  return first.size() >= criteria::kFewestHeld &&
         static_cast<double>(capture.size()) >=
             criteria::kRowsHeld * static_cast<double>(first.size()) &&
         held_evenly(first);
}

/// The rows `first` of a capture.
FreshReadings only(const Capture &capture, const std::vector<std::size_t> &first) {
  FreshReadings out;
  out.rows_a_reading = static_cast<double>(capture.size()) / static_cast<double>(first.size());
  Capture &fresh = out.capture;
  fresh.meta = capture.meta;
  fresh.meta.sample_rate_hz.reset(); // of the rows
  fresh.identity = capture.identity;
  fresh.data_file = capture.data_file;
  fresh.ignored_columns = capture.ignored_columns;
  fresh.turned_rad = capture.turned_rad;
  for (auto column : {&Capture::time_s, &Capture::vsin_v, &Capture::vcos_v, &Capture::vtemp_v,
                      &Capture::vdd_v, &Capture::reference_deg})
    if (!(capture.*column).empty())
      for (std::size_t i : first)
        (fresh.*column).push_back((capture.*column)[i]);
  const auto place = [&](std::size_t row) {
    return static_cast<std::size_t>(std::lower_bound(first.begin(), first.end(), row) -
                                    first.begin());
  };
  for (std::size_t i : capture.starts)
    fresh.starts.push_back(place(i));
  for (std::size_t i : capture.gaps)
    fresh.gaps.push_back(place(i));
  return out;
}

/// Rows that repeat a reading, and the changes of the reading about them.
class Repeats {
public:
  explicit Repeats(const Capture &capture) : c_(capture) {
    for (std::size_t i = 1; i < c_.size(); ++i)
      if (change(0, i) != 0.0 || change(1, i) != 0.0)
        changes_.push_back(i);
    half_range_v_ = 0.5 * std::max(bulk(c_.vsin_v).width(), bulk(c_.vcos_v).width());
  }
  static constexpr std::size_t kReach = 4; ///< changes on either side
  const std::vector<std::size_t> &changes() const { return changes_; }
  double change(int channel, std::size_t i) const {
    const std::vector<double> &v = channel == 0 ? c_.vsin_v : c_.vcos_v;
    return v[i] - v[i - 1];
  }
  /// How far a channel goes at the changes about the k-th, V: of which few lie between the stops of
  /// a table.
  double way_v(int channel, std::size_t k) const {
    return middle_of(k, [&](std::size_t i) { return std::abs(change(channel, i)); });
  }
  /// Whether the shaft stands in the rows before the k-th change, which takes the pair `way_v` on:
  /// its reference says so; or the pair goes on from where it stood, or by moves far apart.
  bool rests(std::size_t k, double way_v) const;

private:
  template <class Of> double middle_of(std::size_t k, const Of &of) const {
    std::array<double, 2 * kReach> about;
    for (std::size_t near = 0; near < kReach; ++near) {
      about[near] = of(changes_[k - kReach + near]);
      about[kReach + near] = of(changes_[k + 1 + near]);
    }
    for (double &v : about) // of a reading that is no number
      v = std::isfinite(v) ? v : std::numeric_limits<double>::infinity();
    std::nth_element(about.begin(), about.begin() + kReach, about.end());
    return about[kReach];
  }
  /// However far that is, by its way from row to row.
  double turns_deg(std::size_t from, std::size_t to) const {
    double way = 0.0;
    for (std::size_t i = from + 1; i <= to; ++i)
      way += wrap_centred(c_.reference_deg[i] - c_.reference_deg[i - 1], 360.0);
    return std::abs(way);
  }
  const Capture &c_;
  std::vector<std::size_t> changes_;
  double half_range_v_ = 0.0;
};

bool Repeats::rests(std::size_t k, double way_v) const {
  constexpr double kHalf = 0.5;
  const std::size_t first = changes_[k - 1], last = changes_[k] - 1;
  const auto rows = static_cast<double>(last - first);
  if (c_.has_reference()) {
    const double way_deg = middle_of(k, [&](std::size_t i) { return turns_deg(i - 1, i); });
    return !(turns_deg(first, last) >= kHalf * rows * way_deg);
  }
  if (last - first <= kReach)
    return false;
  const double apart = middle_of(k, [&](std::size_t i) {
    return static_cast<double>(i -
                               *std::prev(std::lower_bound(changes_.begin(), changes_.end(), i)));
  });
  if (apart > 1.0)
    return true;
  // Of more than a part of the turn the chord says nothing.
  return rows * way_v < half_range_v_ &&
         std::hypot(change(0, last + 1), change(1, last + 1)) < kHalf * rows * way_v;
}

} // namespace

std::optional<FreshReadings> fresh_readings(const Capture &capture) {
  const std::vector<std::size_t> of_pair = first_rows(capture, {&capture.vsin_v, &capture.vcos_v});
  if (held(capture, of_pair) && both_differ(capture, of_pair) >= criteria::kBothDiffer)
    return only(capture, of_pair);
  if (!capture.has_reference())
    return std::nullopt;
  const std::vector<std::size_t> of_reference = first_rows(capture, {&capture.reference_deg});
  if (!held(capture, of_reference) || !steps_differ(capture, of_reference) ||
      !pair_goes_on(capture, of_reference))
    return std::nullopt;
  FreshReadings out = only(capture, of_reference);
  out.of_reference = true;
  return out;
}

StaleRows leave_out_stale_rows(const Capture &capture, std::vector<char> &usable) {
  const double steps[] = {converter_step(capture.vsin_v), converter_step(capture.vcos_v)};
  const Repeats repeats(capture);
  const std::vector<std::size_t> &changes = repeats.changes();
  if (changes.size() + criteria::kFewestStale >= capture.size())
    return {};
  std::vector<std::size_t> stale;
  double by_chance = 0.0;
  StaleRows out;
  for (std::size_t k = Repeats::kReach; k + Repeats::kReach < changes.size(); ++k) {
    double chance = 1.0, goes_on_v2 = 0.0;
    for (int c = 0; c < 2; ++c) {
      const double way = repeats.way_v(c, k);
      goes_on_v2 += way * way;
      // Two readings that differ by d fall on one step of q about once in d/q.
      chance *= way > 0.0 ? std::min(1.0, steps[c] / way) : 1.0;
    }
    if (!std::isfinite(goes_on_v2)) // beside a reading that is no number
      continue;
    const std::size_t rows = changes[k] - changes[k - 1] - 1;
    if (rows > 0 && repeats.rests(k, std::sqrt(goes_on_v2)))
      continue;
    by_chance += chance * static_cast<double>(rows + 1);
    for (std::size_t i = changes[k] - rows; i < changes[k]; ++i)
      stale.push_back(i);
    out.squares_v2 += static_cast<double>(rows) * goes_on_v2;
  }
  out.count = stale.size();
  if (out.count < criteria::kFewestStale ||
      static_cast<double>(out.count) < criteria::kStaleByChance * by_chance)
    return {};
  for (const std::size_t i : stale)
    usable[i] = 0;
  return out;
}

} // namespace ada
