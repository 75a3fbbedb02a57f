// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "health/wrong_stretches.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "base/angle.h"
#include "base/robust.h"
#include "health/criteria.h"
#include "motion/kinematics.h"
#include "motion/own_angle.h"

namespace ada {

namespace {

/// How far from one end to the other the pair goes in some rows, rad.
double way(const std::vector<double> &angle, std::size_t first, std::size_t last) {
  double at = 0.0, low = 0.0, high = 0.0;
  for (std::size_t i = first + 1; i <= last; ++i) {
    const double step = wrap_centred(angle[i] - angle[i - 1], kTwoPi);
    at += std::isfinite(step) ? step : 0.0;
    low = std::min(low, at);
    high = std::max(high, at);
  }
  return high - low;
}

class Blocks {
public:
  explicit Blocks(const Capture &capture) : c_(capture) { last_.fill(kNone); }

  std::vector<RowRange> find() {
    std::size_t lag = 0, first = 0;
    for (std::size_t i = 0; i < c_.size(); ++i) {
      if (lag != 0 && !same(i, i - lag)) {
        close({first, i}, lag);
        lag = 0;
      }
      std::size_t &before = last_[place(i)];
      if (lag == 0 && before != kNone && i - before > 1 && same(i, before)) {
        lag = i - before;
        for (first = i; first > end_of_last_ && first > lag && same(first - 1, first - 1 - lag);)
          --first;
      }
      before = i;
    }
    if (lag != 0)
      close({first, c_.size()}, lag);
    // Chance makes more short runs than long ones.
    const bool by_chance = short_runs_ >= found_.size();
    const bool all_the_time = static_cast<double>(rows_of(found_)) >
                              health::kMostRepeated * static_cast<double>(c_.size());
    return by_chance || all_the_time ? std::vector<RowRange>{} : found_;
  }

private:
  static constexpr std::size_t kNone = ~std::size_t{0};
  static constexpr std::size_t kPlaces = 1 << 14; ///< rows that are remembered

  bool same(std::size_t a, std::size_t b) const {
    return c_.vsin_v[a] == c_.vsin_v[b] && c_.vcos_v[a] == c_.vcos_v[b];
  }
  std::size_t place(std::size_t i) const {
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(c_.vsin_v[i]) * 0x9e3779b97f4a7c15u ^
                               std::bit_cast<std::uint64_t>(c_.vcos_v[i]) * 0xc2b2ae3d27d4eb4fu;
    return static_cast<std::size_t>((bits ^ bits >> 29) * 0x9e3779b97f4a7c15u >> 50) % kPlaces;
  }
  /// Whether the rows are readings of something that moves, or that noise moves: of a pair that
  /// stands between two steps of its converter they are not.
  bool differ(const RowRange &run) const {
    std::vector<std::pair<double, double>> rows;
    for (std::size_t i = run.first; i < run.end; ++i)
      rows.emplace_back(c_.vsin_v[i], c_.vcos_v[i]);
    std::sort(rows.begin(), rows.end());
    const auto distinct =
        static_cast<std::size_t>(std::unique(rows.begin(), rows.end()) - rows.begin());
    return 2 * distinct > run.size();
  }
  void close(const RowRange &run, std::size_t lag) {
    end_of_last_ = run.end;
    // A block that comes more than twice is compared with itself.
    const RowRange once{run.first, std::min(run.end, run.first + lag)};
    if (run.size() < health::kFewestRepeated)
      short_runs_ += run.size() >= health::kShortRepeat ? 1 : 0;
    else if (differ(once))
      found_.push_back(run);
  }

  const Capture &c_;
  std::array<std::size_t, kPlaces> last_{};
  std::vector<RowRange> found_;
  std::size_t short_runs_ = 0, end_of_last_ = 0;
};

} // namespace

std::size_t rows_of(const std::vector<RowRange> &ranges) {
  std::size_t out = 0;
  for (const RowRange &r : ranges)
    out += r.size();
  return out;
}

std::vector<RowRange> held_reference(const Capture &c) {
  if (!c.has_reference())
    return {};
  std::vector<char> begins(c.size(), 0);
  for (const auto *places : {&c.starts, &c.gaps})
    for (const std::size_t i : *places)
      if (i < c.size())
        begins[i] = 1;
  const std::vector<double> angle = own_angle(c);
  std::vector<double> unwrapped = c.reference_deg;
  unwrap(unwrapped, 360.0);
  const double within_deg = health::kStaysWithin * noise_between(unwrapped);
  std::vector<double>().swap(unwrapped);
  const auto stays = [&](std::size_t i, std::size_t as) {
    return std::abs(wrap_centred(c.reference_deg[i] - c.reference_deg[as], 360.0)) <= within_deg;
  };
  struct Held {
    RowRange rows;
    double way;
  };
  std::vector<Held> all;
  std::vector<double> ways;
  for (std::size_t first = 0, end = 0; first < c.size(); first = end) {
    for (end = first + 1; end < c.size() && !begins[end] && stays(end, first);)
      ++end;
    // To the row that has another value: for one row as well the pair goes on.
    const bool goes_on = end < c.size() && !begins[end];
    ways.push_back(way(angle, first, goes_on ? end : end - 1));
    if (end - first >= health::kFewestHeldByReference)
      all.push_back({{first, end}, ways.back()});
  }
  if (all.empty() || ways.size() < health::kFewestValues)
    return {};
  const double usual = quantile(std::move(ways), health::kNearlyAllValues);
  const double noise = noise_between(angle);
  std::vector<RowRange> out;
  for (const Held &h : all)
    if (h.way > health::kHeldLonger * std::max(usual, noise))
      out.push_back({h.rows.first + 1, h.rows.end});
  if (static_cast<double>(rows_of(out)) > health::kMostHeld * static_cast<double>(c.size()))
    return {};
  return out;
}

std::vector<RowRange> repeated_blocks(const Capture &c) {
  return Blocks(c).find();
}

} // namespace ada
