// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// The best model that names nothing: linear regression of a residual on the generic basis, in which
// a block of columns takes part only when held-out data gain by it.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "diagnosis/anonymous/basis.h"
#include "diagnosis/search/fit.h"

namespace ada {

class ColumnSums;
struct SumsOfHalves;

/// Products of all columns with each other and with the residual (the last row), of both parts.
struct Products {
  Eigen::MatrixXd train, heldout;
  double n_train = 0.0, n_heldout = 0.0; ///< values: two a sample
  /// Of those held out, the values that say nothing: half of them where the angle is the pair's
  /// own, and nothing is left across the vector.
  double silent = 0.0;
  double told() const { return n_heldout - silent; }
};

/// Products of the columns with each other and, in the last row and column, with a residual.
/// `known`: of other bases over these samples.
Eigen::MatrixXd gram_of(const Basis &basis, const Observations &data, const ResidualColumns &left,
                        ColumnSums *known = nullptr);

Products products(const Basis &basis, const Observations &train, const ResidualColumns &train_left,
                  const Observations &heldout, const ResidualColumns &heldout_left,
                  SumsOfHalves *known = nullptr);

/// Normal equations with a relative ridge for each column; one of `n` values keeps a column that is
/// zero throughout from taking part.
Eigen::MatrixXd ridged(Eigen::MatrixXd gram, double ridge, const Eigen::VectorXd &stiffness,
                       double n);

/// Which columns take part.
struct Selection {
  std::vector<Eigen::Index> columns;
  Eigen::VectorXd values;                ///< of each, V
  std::array<int, kAxes> orders{};       ///< highest order that is in, by axis; 0: none
  std::array<double, kAxes> share_v2{};  ///< fall of the held-out mean square by axis, V^2
  double steps_v2 = 0.0;                 ///< of that on the axis of time, by steps
  std::array<double, kAxes> gain_nats{}; ///< of the held-out likelihood by axis
  double ridge = 0.0;                    ///< relative, of the normal equations
  double noise_v2 = 0.0;                 ///< held-out mean square that is left
  double train_v2 = 0.0;                 ///< and of the training part
};

/// Axes in their order, on each the highest order that held-out data confirm most.
Selection select(const Basis &basis, const Products &from);

/// The same with columns that were chosen elsewhere; no orders or shares. `ridge`: of that choice,
/// for what may be less to explain: a narrower prior would hold back the same coefficients more.
Selection select(const Basis &basis, const Products &from, std::vector<Eigen::Index> columns,
                 std::optional<double> ridge = std::nullopt);

/// Takes the selection out of a residual.
void subtract(const Basis &basis, const Selection &selection, const Observations &data,
              ResidualColumns &residual);

} // namespace ada
