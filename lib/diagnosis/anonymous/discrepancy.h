// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// What nobody can name, as a part of the noise: the coefficients of the anonymous model are taken
// as normally distributed with the variance that their neighbours show, so that a named cause is
// judged by how far it stands out of what has no name, and its error says so (Kennedy and O'Hagan,
// Bayesian calibration of computer models, J. R. Stat. Soc. B 63, 2001; Brynjarsdottir and O'Hagan,
// Inverse Problems 30, 2014: without such a term parameters come out biased and overconfident).
#pragma once

#include <memory>

#include <Eigen/Cholesky>

#include "diagnosis/anonymous/regression.h"

namespace ada {

/// Generic columns with the prior variance of their coefficients.
struct Discrepancy {
  Basis basis;
  std::vector<Eigen::Index> columns;
  Eigen::VectorXd variance_v2; ///< of the coefficient of each
  double noise_v2 = 0.0;       ///< of what is left, white
  double rest_v2 = 0.0;        ///< of what is left beside all that repeats with the angle
  double freedom = 0.0;        ///< coefficients that a variance is known from, on the average

  explicit operator bool() const { return !columns.empty(); }
};

/// What stands alone among what has no name may yet be named, or was not.
enum class Stands { to_be_named, for_good };

/// From the coefficients that a named model leaves over. On the angle axis the variance of an order
/// is the mean power of its neighbours, without its own: a harmonic that stands alone stands out,
/// one among others of its size does not. Where it stays without a name it is no less than its own:
/// what the covariance does not allow for would bend the sizes of what was named. On the other axes
/// it is the mean over all functions of the axis that act on the pair in the same way.
Discrepancy discrepancy_of(const Basis &basis, const Selection &selection, const Products &from,
                           Stands alone);

/// The covariance sigma^2 + B T B' of one set of observations, by Woodbury's identity.
class Coloured {
public:
  Coloured(const Discrepancy &discrepancy, const Observations &data);

  Eigen::Index columns() const { return rows_.rows(); }
  /// Coefficients that the variance of one is known from, on the average.
  double freedom() const { return freedom_; }
  /// Mean square of a reading that nothing without a name takes either, V^2.
  double rest_v2() const { return rest_v2_; }
  /// Adds the products of the columns with values of samples [first, first + n) to `sum`: `values`
  /// has 2n columns and a row for each column of `sum`.
  void project(std::size_t first, const Eigen::Ref<const Eigen::MatrixXd> &values,
               Eigen::Ref<Eigen::MatrixXd> sum) const;
  /// What the discrepancy takes out of a product matrix X X' whose rows project to `p`:
  /// p' S p with S the posterior covariance of the coefficients over sigma^2.
  Eigen::MatrixXd taken(const Eigen::Ref<const Eigen::MatrixXd> &p) const;

  /// What the discrepancy makes of residuals that project to `p`: its value in each sample, two a
  /// sample.
  Eigen::VectorXd explained(const Eigen::Ref<const Eigen::VectorXd> &p) const;
  /// What is left of values of all samples beside it.
  Eigen::VectorXd unexplained(const Eigen::Ref<const Eigen::VectorXd> &values) const;

private:
  double freedom_, rest_v2_;
  Eigen::MatrixXd rows_; ///< columns of the basis x values of the samples
  Eigen::LDLT<Eigen::MatrixXd> inner_;
};

/// Products of rows, of which each has two values a sample, over many samples: with one another (the
/// lower triangle) and with the columns of a discrepancy, where there is one.
struct Crosses {
  Eigen::MatrixXd products, projected;

  Crosses() = default;
  Crosses(Eigen::Index rows, const Coloured *coloured)
      : products(Eigen::MatrixXd::Zero(rows, rows)),
        projected(Eigen::MatrixXd::Zero(coloured ? coloured->columns() : 0, rows)) {}
  /// `rows` of the samples from `first` on.
  void add(const Eigen::Ref<const Eigen::MatrixXd> &rows, std::size_t first,
           const Coloured *coloured);
  Crosses &operator+=(const Crosses &other);
};

} // namespace ada
