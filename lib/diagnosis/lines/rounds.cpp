// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/lines/rounds.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "base/angle.h"
#include "base/sincos.h"
#include "base/solve.h"
#include "diagnosis/lines/spectrum.h"

namespace ada {

double rounds_of(const Residual &r) {
  const auto [low, high] = std::minmax_element(r.alpha.begin(), r.alpha.end());
  return kTwoPi * r.turns /
         std::clamp(2.0 * (*high - *low), std::numeric_limits<double>::min(), kTwoPi);
}

double comes_round(const Residual &r) {
  constexpr std::size_t kFewest = 4; // times that it is seen to pass the same angle
  constexpr double kEven = 0.01;     // of a turn
  constexpr double kStep = 0.25;     // of a turn; beyond it some turns lie between two samples
  struct Pass {
    double turn, time;
  };
  std::vector<Pass> passes;
  for (std::size_t i = 1; i < r.alpha.size(); ++i) {
    const double before = (r.alpha[i - 1] - r.alpha.front()) / kTwoPi;
    const double after = (r.alpha[i] - r.alpha.front()) / kTwoPi;
    const double turn = std::floor(std::max(before, after));
    if (turn > std::min(before, after) && std::abs(after - before) < kStep)
      passes.push_back(
          {turn, r.time[i - 1] + (r.time[i] - r.time[i - 1]) * (turn - before) / (after - before)});
  }
  if (passes.size() < kFewest || passes.back().turn == passes.front().turn)
    return 0.0;
  const double rate =
      (passes.back().turn - passes.front().turn) / (passes.back().time - passes.front().time);
  const bool even = std::ranges::all_of(passes, [&](const Pass &p) {
    return std::abs((p.time - passes.front().time) * rate - (p.turn - passes.front().turn)) < kEven;
  });
  return even ? std::abs(rate) : 0.0;
}

int order_near(const Residual &r, double frequency, double resolution) {
  // Speeds at which the capture dwells, each with the width of its orders: what the reference reads
  // wrong ripples its speed as well, and whether the line follows the angle is asked apart.
  constexpr double kDwells = 0.02;
  std::vector<double> speed;
  for (double w : r.omega)
    speed.push_back(std::abs(w) / kTwoPi);
  std::sort(speed.begin(), speed.end());
  for (double q : {0.05, 0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85, 0.95}) {
    const auto at = [&](double share) {
      return speed[static_cast<std::size_t>(share * static_cast<double>(speed.size() - 1))];
    };
    const double f = at(q);
    if (f < resolution || at(q + 0.04) - at(q - 0.04) > kDwells * f) // only passed through
      continue;
    const double order = std::round(frequency / f);
    if (order >= 1.0 &&
        std::abs(frequency - order * f) < kOrderWidth * resolution + kDwells * order * f)
      return static_cast<int>(order);
  }
  return 0;
}

namespace {

/// Whether a line is more than an order of the turn beside it, or than something else whose `phase`
/// in rad is given, which may grow and fall over the record, as with the temperature: that leaves
/// more than half of what both take. Where the record is too short to tell the two apart, either
/// takes all.
template <class Phase> bool told_from(const Residual &r, Phase phase, double frequency) {
  constexpr int kOfOrder = 6; // a parabola over the record of either phase
  using Row = Eigen::Matrix<double, kOfOrder + 2, 1>;
  Eigen::Matrix<double, kOfOrder + 2, kOfOrder + 2> normal;
  Eigen::Matrix<double, kOfOrder + 2, 2> onto;
  normal.setZero();
  onto.setZero();
  std::vector<std::array<double, 2>> of_order(r.time.size());
  for_each_sincos(r.time.size(), phase, [&](std::size_t i, double s, double c) {
    of_order[i] = {s, c};
  });
  const double middle = 0.5 * (r.time.front() + r.time.back()),
               half = std::max(0.5 * (r.time.back() - r.time.front()), 1e-12);
  for_each_sincos(
      r.time.size(), [&](std::size_t i) { return kTwoPi * frequency * r.time[i]; },
      [&](std::size_t i, double s, double c) {
        const auto &[sine, cosine] = of_order[i];
        const double x = (r.time[i] - middle) / half;
        Row row;
        row << sine, cosine, x * sine, x * cosine, x * x * sine, x * x * cosine, s, c;
        normal += row * row.transpose();
        onto += row * Eigen::RowVector2d(r.sin_v[i], r.cos_v[i]);
      });
  const auto taken = [&](Eigen::Index columns) { // by the first of them, V^2
    const Eigen::MatrixXd a = normal.topLeftCorner(columns, columns), b = onto.topRows(columns);
    return (b.array() * solved(a, b).array()).sum();
  };
  const double both = taken(kOfOrder + 2);
  return both - taken(kOfOrder) > 0.5 * both;
}

} // namespace

bool told_from_order(const Residual &r, int order, double frequency) {
  return told_from(
      r, [&](std::size_t i) { return order * r.alpha[i]; }, frequency);
}

double comes_back(const Residual &r) {
  constexpr double kEven = 0.8;   // of the mean square of the motion in one line
  constexpr double kFewest = 8.0; // times
  if (r.arc_turns() > 1.0)
    return 0.0;
  const double n = static_cast<double>(r.time.size());
  const double mean = std::accumulate(r.alpha.begin(), r.alpha.end(), 0.0) / std::max(1.0, n);
  PowerOverTime motion;
  add_power_over_time(
      r.time, r.sample_period_s, [&](std::size_t i) { return r.alpha[i] - mean; }, motion);
  if (motion.power.size() < 4)
    return 0.0;
  const auto peak = std::max_element(motion.power.begin() + 2, motion.power.end() - 1);
  const auto share = [&](double hz) { // of the motion
    Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
    Eigen::Vector2d onto = Eigen::Vector2d::Zero();
    double all = 0.0;
    for_each_sincos(
        r.time.size(), [&](std::size_t i) { return kTwoPi * hz * r.time[i]; },
        [&](std::size_t i, double s, double c) {
          const Eigen::Vector2d row(s, c);
          normal += row * row.transpose();
          onto += (r.alpha[i] - mean) * row;
          all += (r.alpha[i] - mean) * (r.alpha[i] - mean);
        });
    return onto.cwiseProduct(solved(normal, onto)).sum() / std::max(all, 1e-30);
  };
  double best = 0.0, at = 0.0;
  for (double beside = -0.6; beside < 0.65; beside += 0.1) {
    const double hz = (static_cast<double>(peak - motion.power.begin()) + beside) * motion.bin_hz;
    if (const double of = share(hz); of > best) {
      best = of;
      at = hz;
    }
  }
  return best > kEven && at * tells_apart_s(r) > kFewest ? at : 0.0;
}

bool of_way_there_and_back(const Residual &r, double back_hz, double frequency) {
  constexpr double kBeyond = 2.0, kWidth = 1.0; // of the resolution: the line's main lobe
  if (!(back_hz > 0.0))
    return false;
  const double multiple = std::round(frequency / back_hz);
  const double highest = highest_named(r) * 0.5 * kTwoPi * r.arc_turns() + kBeyond;
  return multiple >= 1.0 && multiple <= highest &&
         std::abs(frequency - multiple * back_hz) < kWidth / tells_apart_s(r) &&
         !told_from(
             r, [&](std::size_t i) { return kTwoPi * multiple * back_hz * r.time[i]; }, frequency);
}

double seen_at_hz(const Residual &r, double frequency) {
  const double rate = r.sample_period_s > 0.0 ? 1.0 / r.sample_period_s : 0.0;
  return rate > 0.0 ? std::abs(frequency - rate * std::round(frequency / rate)) : frequency;
}

int order_seen_at(const Residual &r, double round_hz, double frequency) {
  if (!(round_hz > 0.0))
    return 0;
  const auto direct = static_cast<int>(std::round(frequency / round_hz));
  const double within = kOrderWidth / tells_apart_s(r);
  if (std::abs(frequency - direct * round_hz) < within)
    return direct;
  // So many orders that a tone lies on one of them by chance in no more than this part of cases.
  constexpr double kByChance = 0.05;
  const double highest = kByChance * (0.5 / std::max(r.sample_period_s, 1e-12)) / (2.0 * within);
  for (int order = 1; order <= std::max(highest, highest_named(r)); ++order)
    if (std::abs(frequency - seen_at_hz(r, order * round_hz)) < within)
      return order;
  return direct;
}

bool turns_with_shaft(const Residual &r, int order, const Line &tone) {
  return order != 0 &&
         line_along(r, [&](std::size_t i) { return order * r.alpha[i]; }).power > 0.2 * tone.power;
}

double highest_named(const Residual &r) {
  return (criteria::kNamedPeriods + 1) * r.periods;
}

bool too_few_rounds_for_lines(const Residual &r) {
  return rounds_of(r) < (r.several_speeds ? kFewestRounds : criteria::kFewestUnits);
}

} // namespace ada
