// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What has no name at those orders of the angle at which a cause acts, and not all over the turn.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "diagnosis/anonymous/anonymous.h"

namespace ada {

/// Mean squares at the orders of a cause, V^2 of a channel.
struct AtOwnOrders {
  /// What the likeliest of many shapes takes by chance, by what the neighbours of these orders
  /// have.
  double by_chance_v2 = 0.0;
  /// What is left along the vector beside a cause that only turns it. Flaws of a magnet turn the
  /// vector: a length that changes as much as the cause turns it is the rest of what the cause is a
  /// part of. One that changes the length itself says by how much, and accounts for no more of it.
  double left_along_v2 = 0.0;
};

/// Beside one model. `left`: what that leaves over; `some`: samples by which a shape is known.
class OwnOrders {
public:
  OwnOrders(const Anonymous &left, Observations some);

  /// Of the cause by which two models differ.
  AtOwnOrders of(const Model &with, const Model &without) const;

private:
  /// Squares of the coefficients that the shape of a cause has on the columns.
  Eigen::VectorXd acts(const Model &with, const Model &without) const;
  /// Part of a column's power that lies along the vector.
  double part_along(Eigen::Index column) const;
  int order(Eigen::Index column) const;

  const Anonymous &left_;
  Observations some_;
  std::vector<Eigen::Index> columns_; ///< of the basis, that repeat with the angle
  Eigen::VectorXd variances_v2_;      ///< of a coefficient of each, by its neighbours
  Eigen::MatrixXd rows_;              ///< columns x values of the samples
};

} // namespace ada
