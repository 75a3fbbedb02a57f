// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Small dense systems. Each decomposition of a matrix library that is a set of templates takes the
// compiler seconds in every file that names it: here it does so once.
#pragma once

#include <Eigen/Core>

namespace ada {

/// X of `normal` X = `right`, n x n and n x m, by Eigen's LDLT. `normal` is symmetric and has no
/// negative eigenvalue: products of columns with themselves. Where columns depend on others, those
/// that are eliminated last get 0; not finite where the numbers are not.
Eigen::MatrixXd solved(const Eigen::Ref<const Eigen::MatrixXd> &normal,
                       const Eigen::Ref<const Eigen::MatrixXd> &right);

/// The same where only the lower triangle of `normal` holds numbers.
Eigen::MatrixXd solved_lower(const Eigen::Ref<const Eigen::MatrixXd> &normal,
                             const Eigen::Ref<const Eigen::MatrixXd> &right);

} // namespace ada
