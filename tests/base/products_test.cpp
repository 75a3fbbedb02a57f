// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Products by vectors against Eigen's, for all shapes about the sizes of a tile.

#include "base/products.h"

#include <gtest/gtest.h>
#include <random>

namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Largest difference, in units of what two sums of so many products can lose to rounding: each
/// addition half an epsilon of the sum of absolute products (Higham, Accuracy and Stability of
/// Numerical Algorithms, 2002, 3.1).
double off(const MatrixXd &got, const MatrixXd &expected, const MatrixXd &sizes, Index terms) {
  const double each = 1.2e-16 * static_cast<double>(2 * (terms + 2));
  return ((got - expected).array().abs() / (sizes.array() * each + 1e-300)).maxCoeff();
}

class Products : public testing::TestWithParam<Index> {};

TEST_P(Products, are_those_of_eigen) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::srand(seed);
  const Index rows = GetParam();
  for (Index others : {1, 2, 3, 4, 5, 7, 8, 11, 30})
    for (Index columns : {0, 1, 3, 127, 128, 129, 300}) {
      // Parts of larger matrices: what lies beside them is neither read into a sum nor written.
      const MatrixXd a = MatrixXd::Random(rows + 5, columns + 2),
                     b = MatrixXd::Random(others + 3, columns + 2);
      const auto part_a = a.block(2, 1, rows, columns), part_b = b.block(1, 1, others, columns);
      MatrixXd out = MatrixXd::Random(rows + 2, others + 2);
      const MatrixXd before = out;
      MatrixXd expected = out;
      expected.block(1, 1, rows, others) += part_a * part_b.transpose();
      ada::add_products(part_a, part_b, out.block(1, 1, rows, others));
      MatrixXd sizes = before.cwiseAbs();
      sizes.block(1, 1, rows, others) += part_a.cwiseAbs() * part_b.cwiseAbs().transpose();
      EXPECT_LT(off(out, expected, sizes, columns), 1.0)
          << rows << " x " << others << " x " << columns;
    }
}

TEST_P(Products, squares_have_their_lower_triangle) {
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::srand(seed);
  const Index rows = GetParam();
  for (Index columns : {0, 1, 128, 200}) {
    const MatrixXd a = MatrixXd::Random(rows, columns);
    const MatrixXd before = MatrixXd::Random(rows, rows);
    MatrixXd out = before;
    ada::add_squares(a, out);
    const MatrixXd expected = before + a * a.transpose();
    const MatrixXd sizes = before.cwiseAbs() + a.cwiseAbs() * a.cwiseAbs().transpose();
    EXPECT_LT(off(out.triangularView<Eigen::Lower>(), expected.triangularView<Eigen::Lower>(),
                  sizes, columns),
              1.0)
        << rows << " x " << columns;
  }
}

INSTANTIATE_TEST_SUITE_P(Rows, Products,
                         testing::Values(1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 15, 16, 23, 24, 25,
                                         31, 47, 48, 50, 100));

} // namespace
