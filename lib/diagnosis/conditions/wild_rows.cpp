// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/conditions/wild_rows.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Dense>

#include "base/angle.h"
#include "base/robust.h"
#include "diagnosis/criteria.h"

namespace ada {

namespace {

/// Whether the reference alone departs from the line between its neighbours, by at least half of
/// what a reading is off by: it is then the reference that is wrong there, which is another matter.
bool is_of_reference(const std::vector<double> &angle, std::size_t i, double off_rad) {
  constexpr double kHalf = 0.5;
  if (i == 0 || i + 1 == angle.size())
    return false;
  return std::abs(angle[i] - 0.5 * (angle[i - 1] + angle[i + 1])) > kHalf * off_rad;
}

} // namespace

std::vector<std::size_t> wild_rows(const Capture &c, std::span<const char> usable,
                                   const std::vector<double> &angle) {
  constexpr std::size_t kFewest = 20;
  constexpr std::size_t kOneIn = 20;      // rows of a table; more that stand out are something else
  constexpr int kOrders = 3, kPasses = 6; // electrical
  constexpr double kStandsOut = 8.0, kGap = 2.0;
  const int periods = c.meta.periods_per_turn;
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < c.size(); ++i)
    if (usable[i] && std::isfinite(angle[i]))
      rows.push_back(i);
  if (rows.size() < kFewest || static_cast<double>(rows.size()) >= criteria::kShortTable)
    return {};
  const auto n = static_cast<Eigen::Index>(rows.size());
  Eigen::MatrixXd columns(n, 2 * kOrders + 1), values(n, 2);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::size_t i = rows[static_cast<std::size_t>(k)];
    values.row(k) << c.vsin_v[i], c.vcos_v[i];
    columns(k, 0) = 1.0;
    for (int order = 1; order <= kOrders; ++order) {
      columns(k, 2 * order - 1) = std::cos(order * periods * angle[i]);
      columns(k, 2 * order) = std::sin(order * periods * angle[i]);
    }
  }
  const std::size_t most = rows.size() / kOneIn;
  const double step_v = std::max(converter_step(c.vsin_v), converter_step(c.vcos_v));
  std::vector<Eigen::Index> by_size(rows.size());
  std::iota(by_size.begin(), by_size.end(), 0);
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(n), off(n);
  std::size_t wild = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver(weight.asDiagonal() *
                                                                         columns);
    // How far off, whatever the direction: that of an angle that errs goes with the place.
    off = (values - columns * solver.solve((weight.asDiagonal() * values).eval())).rowwise().norm();
    const double spread = std::max(
        kSigmasOfMedian * quantile(std::vector<double>(off.begin(), off.end()), 0.5), step_v);
    // Of a row that was left out the others tell the less the farther it is from them: the variance
    // of a prediction.
    const Eigen::VectorXd leverage = (columns * solver.pseudoInverse()).rowwise().squaredNorm();
    for (Eigen::Index k = 0; k < n; ++k)
      if (weight[k] == 0.0)
        off[k] /= std::sqrt(1.0 + leverage[k]);
    std::stable_sort(by_size.begin(), by_size.end(),
                     [&](Eigen::Index a, Eigen::Index b) { return off[a] > off[b]; });
    weight.setOnes();
    // Several may be off by as much.
    for (wild = most; wild > 0; --wild)
      if (off[by_size[wild - 1]] >= std::max(kStandsOut * spread, kGap * off[by_size[wild]]))
        break;
    // The largest is left out all the same: it may have bent the fit so far that it does not show.
    for (std::size_t k = 0; k < std::max<std::size_t>(1, wild); ++k)
      weight[by_size[k]] = 0.0;
  }
  // What the lowest orders do not hold is off at the places beside as well, and at an end of an arc
  // nobody knows.
  const auto stands_alone = [&](Eigen::Index at) {
    constexpr double kNear = 3.0, kCalm = 0.25; // usual distances; of what the row is off by
    const double here = angle[rows[static_cast<std::size_t>(at)]];
    double before = -kNear * kTwoPi / static_cast<double>(n), behind = -before;
    double most_before = off[at], most_behind = off[at];
    for (Eigen::Index k = 0; k < n; ++k) {
      const double d = wrap_centred(angle[rows[static_cast<std::size_t>(k)]] - here, kTwoPi);
      if (k == at || weight[k] == 0.0)
        continue;
      if (d <= 0.0 && d > before) {
        before = d;
        most_before = off[k];
      }
      if (d >= 0.0 && d < behind) {
        behind = d;
        most_behind = off[k];
      }
    }
    return std::max(most_before, most_behind) < kCalm * off[at];
  };
  // At its limit a channel may be cut off by a little, in a row of each peak.
  const Range sin = range_of(c.vsin_v, usable), cos = range_of(c.vcos_v, usable);
  const auto may_be_cut = [&](std::size_t row, double off_v) {
    constexpr double kLittle = 0.03; // of half the range
    const auto at_limit = [&](double v, const Range &range) {
      return off_v < kLittle * range.half &&
             std::abs(v - range.middle) > (1.0 - 2.0 * kLittle) * range.half;
    };
    return at_limit(c.vsin_v[row], sin) || at_limit(c.vcos_v[row], cos);
  };
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < wild; ++k)
    if (const std::size_t row = rows[static_cast<std::size_t>(by_size[k])];
        stands_alone(by_size[k]) && !may_be_cut(row, off[by_size[k]]) &&
        !is_of_reference(angle, row, off[by_size[k]] / (periods * std::max(sin.half, cos.half))))
      out.push_back(row);
  return out;
}

} // namespace ada
