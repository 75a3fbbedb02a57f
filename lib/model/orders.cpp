// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <complex>
#include <unsupported/Eigen/FFT>

#include "base/angle.h"
#include "base/robust.h"
#include "model/residual.h"

namespace ada {

namespace {

constexpr double kFewestTurns = 2.0; ///< from one end to the other: broken orders show then
constexpr std::size_t kMostLines = 4;
constexpr std::size_t kLongest = std::size_t{1} << 20; ///< of the transform: 16 MB
/// A line stands this far above the median power: exp(-12 ln 2) of the lines of noise do.
constexpr double kClearPower = 12.0;
/// So many turns' resolutions on either side are a line's surroundings: what a wander of the speed
/// leaves above the motion's cut-off is a hump of that width, and no line.
constexpr std::size_t kSurroundings = 12;

/// The residual's turn of the angle at each sample, mechanical rad.
std::vector<double> turn_of(const Residual &r) {
  std::vector<double> out(r.sin_v.size(), 0.0);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double s = r.model_sin_v[i] - 0.5 * r.supply_v, c = r.model_cos_v[i] - 0.5 * r.supply_v;
    if (const double radius2 = s * s + c * c; radius2 > 0.0)
      out[i] = (r.sin_v[i] * c - r.cos_v[i] * s) / (radius2 * r.periods);
  }
  return out;
}

/// Mean turn in even cells of the unwrapped angle; zeros fill up to a power of two, unless the
/// cells are those of one turn, over which the angle is folded.
struct Cells {
  std::vector<std::complex<float>> mean;
  double turns_in_all = 0.0; ///< that the whole length stands for
};

Cells cells_of(const Residual &r, const std::vector<double> &turn, double first, double turns,
               double cells_a_turn, bool folded) {
  const auto used = static_cast<std::size_t>(std::ceil(turns * cells_a_turn)) + (folded ? 0 : 1);
  std::size_t size = folded ? used : 256;
  while (size < 2 * used && !folded) // twice as long: lines between the bins do not get lost
    size *= 2;
  Cells out{std::vector<std::complex<float>>(size), static_cast<double>(size) / cells_a_turn};
  std::vector<std::uint32_t> count(used, 0);
  for (std::size_t i = 0; i < r.alpha.size(); ++i) {
    const double from_first = r.alpha[i] - first;
    const double way = folded ? wrap(from_first, kTwoPi) : from_first;
    const auto cell = std::min(used - 1, static_cast<std::size_t>(way / kTwoPi * cells_a_turn));
    out.mean[cell] += static_cast<float>(turn[i]);
    ++count[cell];
  }
  for (std::size_t k = 0; k < used; ++k)
    if (count[k] > 1)
      out.mean[k] /= static_cast<float>(count[k]);
  return out;
}

/// Offset of a peak from its highest bin by the parabola through three powers.
double top_of(double before, double at, double after) {
  const double bend = before - 2.0 * at + after;
  return bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
}

/// Median of the powers from one place to before another, which may lie outside; 0 if there is
/// none.
double median_of(const std::vector<double> &power, std::ptrdiff_t from, std::ptrdiff_t to) {
  const auto size = static_cast<std::ptrdiff_t>(power.size());
  std::vector<double> part(power.begin() + std::clamp<std::ptrdiff_t>(from, 0, size),
                           power.begin() + std::clamp<std::ptrdiff_t>(to, 0, size));
  if (part.empty())
    return 0.0;
  const auto middle = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
  std::nth_element(part.begin(), middle, part.end());
  return *middle;
}

/// Where a shaft that stands while it is read stood, and what was left there: means of each stop.
struct StopMeans {
  std::vector<double> alpha, time;
  std::vector<double> cos, sin;       ///< direction of the vector
  std::vector<double> left_c, left_s; ///< V
};

/// Of at most so many stops, the first of the record. Empty where the shaft moves.
StopMeans stop_means(const Residual &r) {
  constexpr std::size_t kMost = 2000;
  // It moves by far more than it seems to at rest, as it is from more than half of the readings to
  // the next.
  constexpr double kAtRest = 0.4, kFarMore = 8.0, kExact = 1e-6; // rad: a reference without noise
  std::vector<double> moves;
  for (std::size_t i = 0; i < r.alpha.size(); ++i) {
    if (r.omega[i] != 0.0f)
      return {};
    if (i > 0)
      moves.push_back(std::abs(r.alpha[i] - r.alpha[i - 1]));
  }
  const double least = std::max(kFarMore * quantile(std::move(moves), kAtRest), kExact);
  StopMeans out;
  double count = 0.0;
  for (std::size_t i = 0; i < r.alpha.size(); ++i) {
    if (i == 0 || std::abs(r.alpha[i] - r.alpha[i - 1]) > least) {
      if (out.alpha.size() == kMost)
        break;
      for (auto *v : {&out.alpha, &out.time, &out.cos, &out.sin, &out.left_c, &out.left_s})
        v->push_back(0.0);
      count = 0.0;
    }
    count += 1.0;
    const double s = r.model_sin_v[i] - 0.5 * r.supply_v, c = r.model_cos_v[i] - 0.5 * r.supply_v;
    const double radius = std::max(std::hypot(s, c), 1e-12);
    const auto add = [&](std::vector<double> &to, double v) {
      to.back() += (v - to.back()) / count;
    };
    add(out.alpha, r.alpha[i]);
    add(out.time, r.time[i]);
    add(out.cos, c / radius);
    add(out.sin, s / radius);
    add(out.left_c, r.cos_v[i]);
    add(out.left_s, r.sin_v[i]);
  }
  return out;
}

/// Whole orders by which the vector turns from stop to stop, beside offsets that go slowly with the
/// time: the likeliest, where as much by chance is one in a thousand (of so many places and orders,
/// white among the places). Places in even steps do not tell an order from what it is short of
/// their number: the lowest of those that do as well to three nats is taken.
std::vector<double> orders_at_stops(const StopMeans &stops) {
  constexpr int kHighest = 128;
  constexpr double kChance = 1e-3;
  constexpr Eigen::Index kStopsOfWave = 8, kMostWaves = 24; ///< half waves of the time
  const auto n = static_cast<Eigen::Index>(stops.alpha.size());
  std::vector<double> places;
  for (double a : stops.alpha)
    places.push_back(wrap(a, kTwoPi));
  std::sort(places.begin(), places.end());
  constexpr double kApart = 1e-3; // rad: stops that come again stand closer than that
  double different = 1.0;
  for (std::size_t i = 1; i < places.size(); ++i)
    different += places[i] - places[i - 1] > kApart ? 1.0 : 0.0;
  const Eigen::Index waves = std::min(n / kStopsOfWave, kMostWaves);
  Eigen::MatrixXd slow = Eigen::MatrixXd::Zero(2 * n, 2 * (waves + 1));
  Eigen::VectorXd left(2 * n);
  const double from = stops.time.front(),
               span = std::max(stops.time.back() - stops.time.front(), 1e-12);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    for (Eigen::Index k = 0; k <= waves; ++k)
      slow(i, k) = slow(n + i, waves + 1 + k) =
          std::cos(kPi * static_cast<double>(k) * (stops.time[at] - from) / span);
    left[i] = stops.left_c[at];
    left[n + i] = stops.left_s[at];
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(slow);
  const Eigen::MatrixXd basis = qr.householderQ() * Eigen::MatrixXd::Identity(2 * n, slow.cols());
  const auto without_slow = [&](Eigen::MatrixXd m) {
    m -= basis * (basis.transpose() * m).eval();
    return m;
  };
  const Eigen::VectorXd rest = without_slow(left);
  std::array<double, kHighest + 1> explained{};
  for (int order = 1; order <= kHighest; ++order) {
    Eigen::MatrixXd turn(2 * n, 2);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double c = std::cos(order * stops.alpha[at]), s = std::sin(order * stops.alpha[at]);
      turn.row(i) << -stops.sin[at] * c, -stops.sin[at] * s;
      turn.row(n + i) << stops.cos[at] * c, stops.cos[at] * s;
    }
    turn = without_slow(std::move(turn));
    const Eigen::Vector2d by = turn.transpose() * rest;
    explained[static_cast<std::size_t>(order)] =
        by.dot((turn.transpose() * turn).eval().completeOrthogonalDecomposition().solve(by));
  }
  constexpr double kAlike = 3.0; // nats
  const double most = *std::max_element(explained.begin(), explained.end());
  const double all = std::max(rest.squaredNorm(), 1e-300), share = most / all;
  const double alike = kAlike * 2.0 * (all - most) / static_cast<double>(2 * n);
  const auto best = std::find_if(explained.begin() + 1, explained.end(),
                                 [&](double e) { return e >= most - alike; }) -
                    explained.begin();
  if (!(most > 0.0) ||
      kHighest * std::pow(std::max(0.0, 1.0 - share), 0.5 * (different - 3.0)) > kChance)
    return {};
  return {static_cast<double>(best)};
}

/// Of a motion over `turns` from one end to the other. `folded`: laid over one turn, of which whole
/// orders show, as many as the cells tell apart; the strongest first.
std::vector<double> lines_over_angle(const Residual &r, const std::vector<double> &turn, double low,
                                     double turns, double a_turn, bool folded) {
  constexpr double kFewestCells = 32.0;
  if (folded && a_turn < kFewestCells)
    return {};
  if (folded) { // a transform of any other length may take long
    turns = 1.0;
    a_turn = static_cast<double>(std::bit_floor(static_cast<std::size_t>(a_turn)));
  }
  const Cells cells = cells_of(r, turn, low, turns, a_turn, folded);
  std::vector<std::complex<float>> line;
  Eigen::FFT<float> fft;
  fft.fwd(line, cells.mean);

  std::vector<double> power(line.size() / 2);
  for (std::size_t k = 0; k < power.size(); ++k)
    power[k] = static_cast<double>(std::norm(line[k]));
  const double floor = kClearPower * median_of(power, 0, static_cast<std::ptrdiff_t>(power.size()));
  // Over a whole turn a whole order is one line of the transform, and has no lobes.
  const std::size_t lobe =
      folded ? 1 : static_cast<std::size_t>(2.0 * cells.turns_in_all / turns) + 1;
  const auto is_line = [&](std::size_t k) {
    if (!(power[k] > floor && power[k] >= power[k - 1] && power[k] > power[k + 1]))
      return false;
    const auto at = static_cast<std::ptrdiff_t>(k), near = static_cast<std::ptrdiff_t>(lobe),
               far = static_cast<std::ptrdiff_t>(kSurroundings * lobe / 2);
    return power[k] > kClearPower * std::max(median_of(power, at - far, at - near),
                                             median_of(power, at + near + 1, at + far + 1));
  };
  std::vector<std::pair<double, std::size_t>> peaks;
  for (std::size_t k = lobe; k + 1 < power.size(); ++k)
    if (is_line(k))
      peaks.emplace_back(power[k], k);
  std::sort(peaks.rbegin(), peaks.rend());

  std::vector<double> orders;
  for (const auto &[height, k] : peaks) {
    const double bin =
        static_cast<double>(k) + (folded ? 0.0 : top_of(power[k - 1], height, power[k + 1]));
    double order = bin / cells.turns_in_all;
    if (std::abs(order - std::round(order)) < 0.25 / turns) // no telling it from the whole one
      order = std::round(order);
    // A line's own side lobes come within a turn's resolution of it.
    if (std::none_of(orders.begin(), orders.end(),
                     [&](double o) { return std::abs(o - order) < (folded ? 0.5 : 2.0 / turns); }))
      orders.push_back(order);
    if (orders.size() == kMostLines)
      break;
  }
  return orders;
}

std::vector<double> orders_of(const Residual &r) {
  const std::size_t n = r.alpha.size();
  constexpr std::size_t kFewestStops = 12;
  if (const StopMeans stops = stop_means(r); stops.alpha.size() >= kFewestStops)
    return orders_at_stops(stops);
  if (n < 256)
    return {};
  const double low = *std::min_element(r.alpha.begin(), r.alpha.end()), turns = r.arc_turns();
  // From one record to the next the angle leaps by more than the speed and the time between say.
  constexpr double kFarther = 2.0, kAndTurns = 0.5;
  double travel = 0.0;
  for (std::size_t i = 1; i < n; ++i) {
    const double step = std::abs(r.alpha[i] - r.alpha[i - 1]) / kTwoPi,
                 went = std::max(std::abs(r.omega[i]), std::abs(r.omega[i - 1])) *
                        (r.time[i] - r.time[i - 1]) / kTwoPi;
    travel += step < kFarther * went + kAndTurns ? step : 0.0;
  }
  if (!(turns > 0.0) || !(travel > 0.0))
    return {};
  // Where no turn follows another in one sense, all are one: whole orders show.
  const bool folded = turns >= 1.0 && turns < kFewestTurns;
  const double most = static_cast<double>(kLongest) / (2.0 * std::max(1.0, turns) + 2.0);
  const double a_turn = std::min(static_cast<double>(n) / travel, most);
  std::vector<double> orders;
  const std::vector<double> turn = turn_of(r);
  if (folded)
    orders = lines_over_angle(r, turn, low, turns, a_turn, true);
  // Others, and those of a part of a turn, once they come often enough to be no course of it.
  for (const double order : lines_over_angle(r, turn, low, turns, a_turn, false))
    if ((turns >= kFewestTurns || order * turns >= kFewestPeriodsOfOrder) &&
        std::none_of(orders.begin(), orders.end(),
                     [&](double o) { return std::abs(o - order) < 2.0 / turns; }))
      orders.push_back(order);
  return orders;
}

} // namespace

double Residual::arc_turns() const {
  return arc.get([&] {
    if (alpha.empty())
      return 0.0;
    const auto [low, high] = std::minmax_element(alpha.begin(), alpha.end());
    return (*high - *low) / kTwoPi;
  });
}

const std::vector<double> &find_orders(const Residual &residual) {
  return residual.orders.get([&] { return orders_of(residual); });
}

} // namespace ada
