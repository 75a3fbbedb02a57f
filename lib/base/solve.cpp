// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
#include "base/solve.h"

#include <Eigen/Cholesky>

namespace ada {

Eigen::MatrixXd solved(const Eigen::Ref<const Eigen::MatrixXd> &normal,
                       const Eigen::Ref<const Eigen::MatrixXd> &right) {
  return normal.ldlt().solve(right);
}

Eigen::MatrixXd solved_lower(const Eigen::Ref<const Eigen::MatrixXd> &normal,
                             const Eigen::Ref<const Eigen::MatrixXd> &right) {
  return normal.selfadjointView<Eigen::Lower>().ldlt().solve(right);
}

} // namespace ada
