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
#include "motion/own_vector.h"

namespace ada {

namespace {

/// How far the pair goes over some rows.
class Way {
public:
  explicit Way(const Capture &c) : own_(own_vector(c)) {}
  const std::vector<double> &angle() const { return own_.angle; }
  /// From one end to the other of where it is, rad.
  double range(std::size_t first, std::size_t last) const {
    double low = 0.0, high = 0.0;
    for (const double at : path(first, last)) {
      low = std::min(low, at);
      high = std::max(high, at);
    }
    return high - low;
  }
  /// Net, rad, as far as it is more than what the pair does about a straight course meanwhile: hum,
  /// a spike or an open contact lead nowhere.
  double net(std::size_t first, std::size_t last) const {
    constexpr std::size_t kAtEnd = 5; // rows whose median is where it is
    std::vector<double> path = this->path(first, last);
    if (path.size() < 2)
      return 0.0;
    if (path.size() < 2 * kAtEnd)
      return std::abs(path.back() - path.front());
    const auto middle = [](auto begin, auto end) { return quantile(std::vector(begin, end), 0.5); };
    const double net =
        middle(path.end() - kAtEnd, path.end()) - middle(path.begin(), path.begin() + kAtEnd);
    const double slope = net / static_cast<double>(path.size() - kAtEnd);
    for (std::size_t i = 0; i < path.size(); ++i)
      path[i] -= slope * static_cast<double>(i);
    return std::max(0.0, std::abs(net) - health::kOfItsScatter * robust_spread(path));
  }

private:
  std::vector<double> path(std::size_t first, std::size_t last) const {
    std::vector<double> out;
    double at = 0.0, before = own_.angle[first];
    for (std::size_t i = first; i <= last; ++i) {
      // Near the centre, and far off the circle, it has no angle that tells.
      if (!(std::abs(own_.length[i] / own_.usual_length_v - 1.0) < 0.5))
        continue;
      at += wrap_centred(own_.angle[i] - before, kTwoPi);
      before = own_.angle[i];
      out.push_back(at);
    }
    return out;
  }

  OwnVector own_;
};

class Blocks {
public:
  explicit Blocks(const Capture &capture) : c_(capture), own_(own_vector(capture)) {
    last_.fill(kNone);
    const double count_v = std::hypot(converter_step(c_.vsin_v), converter_step(c_.vcos_v));
    of_a_count_ = own_.usual_length_v > 0.0 ? count_v / own_.usual_length_v : kTwoPi;
  }

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
    return by_chance() ? std::vector<RowRange>{} : found_;
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
  /// Whether the pair leaves its course where the block begins or ends: a motion that comes again
  /// without noise does not.
  bool breaks_motion(const RowRange &run) const {
    constexpr std::size_t kReach = 8;
    for (const std::size_t at : {run.first, run.end}) {
      if (at == 0 || at >= c_.size())
        continue;
      const auto step = [&](std::size_t i) {
        return wrap_centred(own_.angle[i] - own_.angle[i - 1], kTwoPi);
      };
      std::vector<double> about;
      for (std::size_t i = at > kReach ? at - kReach : 1; i < std::min(c_.size(), at + kReach); ++i)
        if (i != at)
          about.push_back(step(i));
      const double usual = quantile(about, 0.5);
      if (std::abs(step(at) - usual) >
          health::kBreaksMotion * (robust_spread(about) + std::abs(usual) + of_a_count_))
        return true;
    }
    return false;
  }
  void close(const RowRange &run, std::size_t lag) {
    end_of_last_ = run.end;
    // A block that comes more than twice is compared with itself.
    const RowRange once{run.first, std::min(run.end, run.first + lag)};
    if (run.size() < health::kFewestRepeated) {
      of_three_ += run.size() >= health::kShortRepeat ? 1.0 : 0.0;
      of_four_ += run.size() > health::kShortRepeat ? 1.0 : 0.0;
    } else if (differ(once) && breaks_motion(run)) {
      found_.push_back(run);
    }
  }
  /// Chance makes ever fewer of the longer runs, each as many times fewer than the one before: so
  /// many long ones as were found?
  bool by_chance() const {
    const double longer = (of_four_ + 1.0) / (of_three_ + 2.0); // Laplace's rule of succession
    const double expected =
        of_three_ *
        std::pow(longer, static_cast<double>(health::kFewestRepeated - health::kShortRepeat));
    return expected > health::kByChance * static_cast<double>(found_.size());
  }

  const Capture &c_;
  const OwnVector own_;
  std::array<std::size_t, kPlaces> last_{};
  std::vector<RowRange> found_;
  double of_a_count_ = 0.0; ///< rad, by which a count of each converter turns the pair
  double of_three_ = 0.0, of_four_ = 0.0; ///< short runs of so many rows at least
  std::size_t end_of_last_ = 0;
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
  const Way way(c);
  std::vector<double> unwrapped = c.reference_deg;
  unwrap(unwrapped, 360.0);
  const double within_deg = health::kStaysWithin * noise_between(unwrapped);
  std::vector<double>().swap(unwrapped);
  const auto stays = [&](std::size_t i, std::size_t as) {
    return std::abs(wrap_centred(c.reference_deg[i] - c.reference_deg[as], 360.0)) <= within_deg;
  };
  struct Held {
    RowRange rows;
    double way, net, caught_up;
    bool goes_on;
  };
  std::vector<Held> all;
  std::vector<double> ways, rows, steps;
  for (std::size_t first = 0, end = 0; first < c.size(); first = end) {
    for (end = first + 1; end < c.size() && !begins[end] && stays(end, first);)
      ++end;
    // To the row that has another value: for one row as well the pair goes on.
    const bool goes_on = end < c.size() && !begins[end];
    const std::size_t last = goes_on ? end : end - 1;
    const double step =
        goes_on ? std::abs(wrap_centred(c.reference_deg[end] - c.reference_deg[first], 360.0))
                : 0.0;
    ways.push_back(way.range(first, last));
    rows.push_back(static_cast<double>(end - first));
    steps.push_back(step);
    if (end - first >= health::kFewestHeldByReference)
      all.push_back({{first, end}, ways.back(), way.net(first, last), step, goes_on});
  }
  if (all.empty() || ways.size() < health::kFewestValues)
    return {};
  // A line lasts as far as the pair goes, and a poll as long as the next one takes. One that was
  // held has to catch up, unless the record ends, or it was by more than half a turn, of which the
  // step of the reference shows the rest.
  const double half_turn = 0.5 * kTwoPi * c.meta.periods_per_turn;
  const auto usual = [](std::vector<double> of) {
    return health::kHeldLonger * quantile(std::move(of), health::kNearlyAllValues);
  };
  const double longest = usual(rows), largest = usual(steps),
               farthest = std::max(usual(ways), health::kHeldLonger * noise_between(way.angle()));
  std::vector<RowRange> out;
  for (const Held &h : all)
    if (h.way > farthest && static_cast<double>(h.rows.size()) > longest &&
        (h.caught_up > largest || h.net > (h.goes_on ? std::max(half_turn, farthest) : farthest)))
      out.push_back({h.rows.first + 1, h.rows.end});
  if (static_cast<double>(rows_of(out)) > health::kMostHeld * static_cast<double>(c.size()))
    return {};
  return out;
}

std::vector<RowRange> repeated_blocks(const Capture &c) {
  return Blocks(c).find();
}

} // namespace ada
