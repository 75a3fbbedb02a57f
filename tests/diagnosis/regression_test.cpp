// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Normal equations of the generic basis.

#include <random>

#include <gtest/gtest.h>

#include "base/angle.h"
#include "diagnosis/anonymous/column_sums.h"
#include "diagnosis/anonymous/regression.h"
#include "support/seed.h"

namespace ada::test {
namespace {

/// Terms of every kind: orders, conditions, time, lines.
Basis mixed_basis(int periods, double zero_rad = 0.3) {
  Basis out(periods, zero_rad);
  out.add(Axis::angle, 0, 0);
  out.add(Axis::angle, periods, 2 * periods);
  for (int order : {1, 3, 7})
    for (auto kind : {Modulation::angle_cos, Modulation::angle_sin})
      out.add(Axis::angle, order, periods, {kind, order});
  for (int exponent : {0, periods, -periods}) {
    for (auto kind :
         {Modulation::sense, Modulation::velocity, Modulation::speed, Modulation::square})
      out.add(Axis::speed, 1, exponent, {kind});
    for (int order : {1, 2, 3})
      out.add(Axis::temperature, order, exponent, {Modulation::temperature, order});
    out.add(Axis::supply, 1, exponent, {Modulation::supply});
    out.add(Axis::time, 5, exponent, {Modulation::trend, 5});
  }
  for (auto kind : {Modulation::line_cos, Modulation::line_sin})
    out.add(Axis::frequency, 1, 0, {kind, 0, 50.0});
  return out;
}

struct Data {
  Observations data;
  ResidualColumns left;
};

Data random_data(std::size_t n, std::mt19937_64 &rng) {
  std::normal_distribution<> normal;
  std::uniform_real_distribution<> turn(-kTwoPi, kTwoPi);
  Data out;
  Observations &o = out.data;
  for (std::size_t i = 0; i < n; ++i) {
    o.time.push_back(1e-3 * static_cast<double>(i));
    for (auto *column : {&o.vsin, &o.vcos, &o.omega, &o.temp})
      column->push_back(static_cast<float>(normal(rng)));
    o.alpha.push_back(turn(rng));
    o.supply.push_back(static_cast<float>(normal(rng)));
    o.direction.push_back(normal(rng) > 0.0 ? 1 : -1);
    for (auto *column : {&out.left.sin, &out.left.cos, &out.left.model_sin, &out.left.model_cos})
      column->push_back(normal(rng));
  }
  return out;
}

TEST(Regression, sums_of_exponentials_are_the_products_of_the_columns) {
  std::mt19937_64 rng(fresh_seed());
  for (int periods : {1, 2, 5}) {
    const Data d = random_data(700, rng); // several blocks and a part of one
    Basis basis = mixed_basis(periods);
    basis.scale_to(d.data);
    const auto m = static_cast<Eigen::Index>(basis.columns());
    const auto values = static_cast<Eigen::Index>(2 * d.data.size());
    Eigen::MatrixXd rows(m + 1, values);
    basis.evaluate(d.data, 0, d.data.size(), rows.topRows(m));
    for (std::size_t i = 0; i < d.data.size(); ++i) {
      rows(m, static_cast<Eigen::Index>(2 * i)) = d.left.sin[i];
      rows(m, static_cast<Eigen::Index>(2 * i + 1)) = d.left.cos[i];
    }
    const Eigen::MatrixXd gram = gram_of(basis, d.data, d.left);
    ASSERT_EQ(gram.rows(), m + 1);
    // Sums of some thousand products of about one: rounding is far below a billionth of that.
    EXPECT_LT((gram - rows * rows.transpose()).cwiseAbs().maxCoeff(),
              1e-12 * static_cast<double>(values));
  }
}

TEST(Regression, sums_that_are_kept_serve_other_bases_and_zeros) {
  std::mt19937_64 rng(fresh_seed());
  ColumnSums known;
  const Data first = random_data(700, rng), other = random_data(600, rng);
  for (const Data *d : {&first, &first, &other, &first})
    for (double zero_rad : {0.0, 0.7, -2.0})
      for (double line_hz : {0.0, 30.0, 70.0}) {
        Basis basis = mixed_basis(2, zero_rad);
        if (line_hz > 0.0)
          basis.add(Axis::frequency, 2, 2, {Modulation::line_cos, 0, line_hz});
        basis.scale_to(d->data);
        const Eigen::MatrixXd alone = gram_of(basis, d->data, d->left);
        EXPECT_LT((gram_of(basis, d->data, d->left, &known) - alone).cwiseAbs().maxCoeff(), 1e-9);
      }
}

TEST(Regression, what_is_subtracted_is_the_sum_of_the_columns) {
  std::mt19937_64 rng(fresh_seed());
  std::normal_distribution<> normal;
  for (int periods : {1, 2, 5})
    for (bool functions : {false, true}) {
      Data d = random_data(700, rng);
      Basis basis = mixed_basis(periods);
      basis.scale_to(d.data);
      Selection some;
      const auto columns = static_cast<Eigen::Index>(functions ? basis.columns() : 10);
      for (Eigen::Index k = 0; k < columns; ++k)
        if (normal(rng) > 0.0)
          some.columns.push_back(k);
      some.values.resize(static_cast<Eigen::Index>(some.columns.size()));
      for (double &v : some.values)
        v = normal(rng);
      Eigen::MatrixXd rows(static_cast<Eigen::Index>(basis.columns()),
                           static_cast<Eigen::Index>(2 * d.data.size()));
      basis.evaluate(d.data, 0, d.data.size(), rows);
      const Eigen::VectorXd sum = rows(some.columns, Eigen::all).transpose() * some.values;
      ResidualColumns left = d.left;
      subtract(basis, some, d.data, left);
      for (std::size_t i = 0; i < d.data.size(); ++i) {
        const auto at = static_cast<Eigen::Index>(2 * i);
        ASSERT_NEAR(left.sin[i], d.left.sin[i] - sum[at], 1e-10);
        ASSERT_NEAR(left.cos[i], d.left.cos[i] - sum[at + 1], 1e-10);
      }
    }
}

TEST(Regression, weights_act_on_columns_and_residual_alike) {
  std::mt19937_64 rng(fresh_seed());
  for (Direction direction : {Direction::supply, Direction::motion, Direction::radius})
    for (int periods : {1, 2, 5})
      for (double weight : {0.02, 0.5, 3.0}) {
        Data d = random_data(700, rng);
        Basis basis = mixed_basis(periods, 0.3);
        basis.scale_to(d.data);
        d.data.disturbed = direction;
        d.data.weight_along = weight;
        const auto m = static_cast<Eigen::Index>(basis.columns());
        const auto n = static_cast<Eigen::Index>(d.data.size());
        Eigen::MatrixXd rows(m + 1, 2 * n);
        basis.evaluate(d.data, 0, d.data.size(), rows.topRows(m));
        for (Eigen::Index i = 0; i < n; ++i) {
          const auto k = static_cast<std::size_t>(i);
          rows(m, 2 * i) = d.left.sin[k];
          rows(m, 2 * i + 1) = d.left.cos[k];
          const auto whiten = d.data.whitener_at(k, d.left.model_sin[k], d.left.model_cos[k]);
          for (Eigen::Index row = 0; row <= m; ++row)
            whiten(rows(row, 2 * i), rows(row, 2 * i + 1));
        }
        EXPECT_LT((gram_of(basis, d.data, d.left) - rows * rows.transpose()).cwiseAbs().maxCoeff(),
                  1e-12 * static_cast<double>(2 * n) * std::max(1.0, weight * weight));
      }
}

} // namespace
} // namespace ada::test
