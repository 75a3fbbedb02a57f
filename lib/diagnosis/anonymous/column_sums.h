// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Sums over samples of what generic bases multiply: h h' e^(j k x), with h and h' functions of the
// conditions. They depend on the samples alone, and one basis after the other over the same samples
// has most of them in common: what was summed once is kept.
#pragma once

#include <complex>
#include <cstddef>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "diagnosis/anonymous/basis.h"
#include "diagnosis/conditions/observations.h"

namespace ada {

/// For one thread.
class ColumnSums {
public:
  using Complex = std::complex<double>;

  /// What is to be there: of the angles of `data`, without the zero angle of a model, times `unit`.
  /// `basis` scales the functions.
  struct Needed {
    const Basis &basis;
    const Observations &data;
    int unit;
    std::vector<Modulation> functions;
    int plain, mixed;       ///< highest exponents without a function, and with one
    std::vector<int> pairs; ///< exponents, from 0, with two functions
  };
  /// Sums what is not there yet.
  void need(const Needed &needed);

  /// Sum of e^(j k x), the same times the function in this place, and times two; k from 0.
  Complex plain(int k) const { return plain_[k]; }
  Complex mixed(std::size_t function, int k) const {
    return mixed_(static_cast<Eigen::Index>(function), k);
  }
  Complex between(std::size_t function, std::size_t other, int k) const {
    return between_.at(k)(static_cast<Eigen::Index>(function), static_cast<Eigen::Index>(other));
  }
  std::size_t place_of(const Modulation &function) const;
  /// Values of all functions that were ever needed: a row for each, a column for each sample.
  const Eigen::MatrixXd &values() const { return values_; }

private:
  bool serves(const Needed &needed) const;
  void begin(const Needed &needed);
  void add(const std::vector<Modulation> &functions, const Needed &needed);

  /// The samples, by all that the functions of a basis look at.
  Observations samples_;
  Basis scale_;
  int unit_ = 0;
  std::vector<Modulation> functions_;
  Eigen::MatrixXd values_;
  Eigen::VectorXcd plain_;                  ///< by exponent
  Eigen::MatrixXcd mixed_;                  ///< by function and exponent
  std::map<int, Eigen::MatrixXcd> between_; ///< of two functions, by exponent
};

/// e^(j k x) for k from 0 to the number of rows less one: a row for each k, a column for each x.
void powers(const Eigen::Ref<const Eigen::VectorXd> &angles, Eigen::Ref<Eigen::MatrixXd> cosine,
            Eigen::Ref<Eigen::MatrixXd> sine);

/// Of both halves that an anonymous model is fitted to and judged on.
struct SumsOfHalves {
  ColumnSums train, heldout;
};

} // namespace ada
