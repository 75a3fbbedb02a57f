// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/events/edges.h"

#include <algorithm>
#include <cmath>

#include "base/robust.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// Straight lines in time through a number of samples each, from running sums.
class Lines {
public:
  Lines(std::span<const double> time, std::span<const double> x)
      : t_(time.size()), sums_(time.size() + 1) {
    const double unit = median_step(time);
    for (std::size_t i = 0; i < x.size(); ++i) {
      t_[i] = (time[i] - time[0]) / (unit > 0.0 ? unit : 1.0);
      sums_[i + 1] = sums_[i];
      sums_[i + 1].add(t_[i], x[i]);
    }
  }
  /// What the line through `reach` samples behind a place is above the one through as many before
  /// it, half way between the two samples.
  double jump(std::size_t at, std::size_t reach) const {
    const double middle = 0.5 * (t_[at - 1] + t_[at]);
    return line_at(middle, at, reach) - line_at(middle, at - reach, reach);
  }

private:
  struct Sums {
    double t = 0.0, tt = 0.0, x = 0.0, tx = 0.0;
    void add(double at, double value) {
      t += at;
      tt += at * at;
      x += value;
      tx += at * value;
    }
  };
  double line_at(double where, std::size_t first, std::size_t reach) const {
    const Sums &from = sums_[first], &to = sums_[first + reach];
    const double m = static_cast<double>(reach), t = (to.t - from.t) / m, x = (to.x - from.x) / m;
    const double spread = to.tt - from.tt - m * t * t;
    const double slope = spread > 0.0 ? (to.tx - from.tx - m * t * x) / spread : 0.0;
    return x + slope * (where - t);
  }

  std::vector<double> t_;
  std::vector<Sums> sums_;
};

double size_of(const Edge &e) {
  return std::hypot(e.first, e.second);
}

} // namespace

std::size_t reach_of_edges(std::size_t samples, double rounds, int periods_per_turn) {
  constexpr double kQuarters = 4.0; // of a wave
  const double waves = rounds * (criteria::kNamedPeriods + 1) * periods_per_turn;
  return std::max(kFewestOfEdge, static_cast<std::size_t>(static_cast<double>(samples) /
                                                          std::max(1.0, kQuarters * waves)));
}

std::vector<Edge> find_edges(std::span<const double> time, std::span<const double> first,
                             std::span<const double> second, std::span<const signed char> sense,
                             std::size_t reach, std::size_t most) {
  const std::size_t n = first.size();
  std::vector<Edge> out;
  if (n < 4 * reach)
    return out;
  const Lines a(time, first), b(time, second);
  const auto edge_at = [&](std::size_t k, std::size_t r) {
    return Edge{k, a.jump(k, r), b.jump(k, r)};
  };
  const auto usual = [&](std::size_t r) {
    constexpr std::size_t kEnough = 20000;
    std::vector<double> sizes;
    for (std::size_t k = r; k + r <= n; k += 1 + n / kEnough)
      sizes.push_back(size_of(edge_at(k, r)));
    return quantile(std::move(sizes), 0.5);
  };
  // Places about which the shaft turns in one sense.
  std::vector<Edge> all;
  std::size_t turned = 0; // the last sample that turns in another sense than the one before
  for (std::size_t i = 1; i < n; ++i) {
    if (sense[i] != sense[i - 1])
      turned = i;
    if (i + 1 >= 2 * reach && turned + 2 * reach <= i + 1)
      all.push_back(edge_at(i + 1 - reach, reach));
  }
  // Where lines usually meet to the last bit, what does not is a converter's step.
  const double middle = usual(reach);
  if (!(middle > 0.0))
    return out;
  std::erase_if(all, [&](const Edge &e) { return !(size_of(e) > criteria::kJump * middle); });
  // A burst, a bump or what settles is smaller between shorter lines; noise moves the place by a
  // few samples.
  constexpr std::size_t kShortest = 4, kMoved = 2;
  constexpr double kAsLarge = 0.6, kAboveNoise = 6.0;
  std::vector<std::pair<std::size_t, double>> shorter;
  for (std::size_t r = reach / 2; r >= kShortest; r /= 2)
    shorter.emplace_back(r, usual(r));
  const auto is_sharp = [&](const Edge &e) {
    for (const auto &[r, noise] : shorter) {
      if (size_of(e) < kAboveNoise * noise)
        return true;
      double largest = 0.0;
      for (std::size_t k = e.at - kMoved; k <= std::min(e.at + kMoved, n - r); ++k) {
        const Edge near = edge_at(k, r);
        largest = std::max(largest, (near.first * e.first + near.second * e.second) / size_of(e));
      }
      if (largest < kAsLarge * size_of(e))
        return false;
    }
    return true;
  };
  std::vector<Edge> peaks; // the largest of those about each place
  while (!all.empty() && peaks.size() < 4 * most) {
    const Edge best = *std::max_element(all.begin(), all.end(), [](const Edge &x, const Edge &y) {
      return size_of(x) < size_of(y);
    });
    peaks.push_back(best);
    std::erase_if(all, [&](const Edge &e) {
      return std::max(e.at, best.at) - std::min(e.at, best.at) < 2 * reach;
    });
  }
  for (const Edge &edge : peaks) {
    if (out.size() == most)
      break;
    if (is_sharp(edge))
      out.push_back(edge);
  }
  // A narrow flaw ends as it began: two edges against each other are no events.
  constexpr std::size_t kBeside = 6; // reaches
  constexpr double kUndone = 0.5;
  std::vector<char> undone(out.size(), 0);
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::size_t k = 0; k < peaks.size(); ++k) {
      const Edge &x = out[i], &y = peaks[k];
      const std::size_t apart = std::max(x.at, y.at) - std::min(x.at, y.at);
      undone[i] |= apart > 0 && apart < kBeside * reach &&
                   x.first * y.first + x.second * y.second < -kUndone * size_of(x) * size_of(x);
    }
  std::vector<Edge> kept;
  for (std::size_t i = 0; i < out.size(); ++i)
    if (!undone[i])
      kept.push_back(out[i]);
  return kept;
}

} // namespace ada
