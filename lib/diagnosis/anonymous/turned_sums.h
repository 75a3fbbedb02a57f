// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Sums of products of columns that are to be weighed along a direction of their own at each sample.
// With U the unit vector of that direction, w the weight along it, and A and B two complex columns,
//
//   w^2 Re(A U*) Re(B U*) + Im(A U*) Im(B U*) = (w^2 + 1)/2 Re(A B*) + (w^2 - 1)/2 Re(A B U*^2),
//
// of which the first is the product without weights. The second has as few different sums as the
// first: of each exponent, times V = U*^2.
#pragma once

#include <Eigen/Core>

#include "diagnosis/anonymous/pieces.h"
#include "diagnosis/search/fit.h"

namespace ada {

/// Re of the sums of A B U*^2 for all columns and, in the last row and column, the residual.
/// `values`: those of the functions of the pieces, a row for each, a column for each sample.
Eigen::MatrixXd turned_gram(const Basis &basis, const Pieces &pieces, const Observations &data,
                            const ResidualColumns &left, const Eigen::MatrixXd &values);

} // namespace ada
