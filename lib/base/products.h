// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Products of tall matrices, summed over samples, by the best vector unit of the machine: Eigen's
// own are bound to the one that the library was compiled for.
#pragma once

#include <Eigen/Core>

namespace ada {

/// out += a b'. A column of `a` and of `b` is a sample, a row a quantity of it; out(i, k) belongs
/// to row i of `a` and row k of `b`.
void add_products(const Eigen::Ref<const Eigen::MatrixXd> &a,
                  const Eigen::Ref<const Eigen::MatrixXd> &b, Eigen::Ref<Eigen::MatrixXd> out);

/// out += a a', the diagonal and what lies below it; above it `out` holds nothing of use.
void add_squares(const Eigen::Ref<const Eigen::MatrixXd> &a, Eigen::Ref<Eigen::MatrixXd> out);

} // namespace ada
