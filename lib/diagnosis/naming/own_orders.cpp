// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/naming/own_orders.h"

#include <cmath>
#include <cstdint>
#include <numeric>
#include <set>
#include <utility>

#include <Eigen/Dense>

#include "base/solve.h"
#include "diagnosis/anonymous/discrepancy.h"
#include "diagnosis/criteria.h"

namespace ada {

OwnOrders::OwnOrders(const Anonymous &left, Observations some)
    : left_(left), some_(std::move(some)) {
  constexpr std::size_t kEnough = 1000; // samples, for what an effect does by its law
  const Discrepancy about =
      discrepancy_of(left.basis, left.selection, left.from, Stands::to_be_named);
  std::vector<Eigen::Index> places;
  for (std::size_t k = 0; k < about.columns.size(); ++k)
    if (left.basis.groups()[static_cast<std::size_t>(about.columns[k] / 2)].axis == Axis::angle) {
      columns_.push_back(about.columns[k]);
      places.push_back(static_cast<Eigen::Index>(k));
    }
  if (columns_.empty())
    return;
  variances_v2_ = about.variance_v2(places);
  std::vector<std::uint32_t> every(some_.size());
  std::iota(every.begin(), every.end(), 0u);
  some_.keep(thin(every, kEnough, 100));
  Eigen::MatrixXd all(static_cast<Eigen::Index>(left.basis.columns()),
                      static_cast<Eigen::Index>(2 * some_.size()));
  left.basis.evaluate(some_, 0, some_.size(), all);
  rows_ = all(columns_, Eigen::all);
}

Eigen::VectorXd OwnOrders::acts(const Model &with, const Model &without) const {
  const ResidualColumns rest = residual_columns(some_, with),
                        more = residual_columns(some_, without);
  Eigen::VectorXd shape(rows_.cols());
  for (std::size_t i = 0; i < some_.size(); ++i)
    shape.segment<2>(static_cast<Eigen::Index>(2 * i)) << more.sin[i] - rest.sin[i],
        more.cos[i] - rest.cos[i];
  return solved(rows_ * rows_.transpose(), rows_ * shape).array().square().matrix();
}

// Real coefficients of a modulated vector lie along it; of the one side that the order of a period
// has half does.
double OwnOrders::part_along(Eigen::Index column) const {
  const bool one_side =
      left_.basis.terms()[static_cast<std::size_t>(column / 2)].modulation.kind == Modulation::none;
  return one_side ? 0.5 : column % 2 == 0 ? 1.0 : 0.0;
}

int OwnOrders::order(Eigen::Index column) const {
  return left_.basis.groups()[static_cast<std::size_t>(column / 2)].order;
}

AtOwnOrders OwnOrders::of(const Model &with, const Model &without) const {
  constexpr double kActs = 0.05;     // of the largest square
  constexpr double kOnlyTurns = 0.1; // of its power lies along the vector
  AtOwnOrders out;
  if (columns_.empty())
    return out;
  const Eigen::VectorXd squares = acts(with, without);
  std::set<int> orders;
  double along = 0.0; // of a single side nobody tells which it is
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(k);
    if (part_along(columns_[k]) == 1.0)
      along += squares[at];
    if (squares[at] < kActs * squares.maxCoeff())
      continue;
    out.by_chance_v2 += 0.5 * criteria::kLikeliestOfShapes * variances_v2_[at];
    orders.insert(order(columns_[k]));
  }
  if (along > kOnlyTurns * squares.sum())
    return out;
  for (std::size_t k = 0; k < left_.selection.columns.size(); ++k) {
    const Eigen::Index column = left_.selection.columns[k];
    const Axis axis = left_.basis.groups()[static_cast<std::size_t>(column / 2)].axis;
    if (axis == Axis::angle && order(column) != kOfBaseline && orders.contains(order(column)))
      out.left_along_v2 += 0.5 * part_along(column) *
                           std::pow(left_.selection.values[static_cast<Eigen::Index>(k)], 2);
  }
  return out;
}

} // namespace ada
