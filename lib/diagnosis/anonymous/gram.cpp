// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors
//
// Normal equations of the generic basis. A term is a sum of h e^(j k x) with h one of few functions
// of the conditions, so that the product of two terms is the sum over all samples of
// h h' e^(j (k' - k) x): a table by h, h' and k' - k holds them all. That takes the samples times
// the orders, where the products of all columns would take the samples times their square.

#include <algorithm>
#include <complex>
#include <map>

#include "base/products.h"
#include "diagnosis/anonymous/regression.h"
#include "diagnosis/over_samples.h"

namespace ada {

namespace {

using Complex = std::complex<double>;

class Sums {
public:
  Sums(const Basis &basis, const Observations &data, const ResidualColumns &left) : basis_(basis) {
    take_apart();
    sums_ = sum_over(data.size(), nothing(), [&](Tables &sums, std::size_t first, std::size_t n) {
      add(data, left, first, n, sums);
    });
  }

  Eigen::MatrixXd gram() const {
    const auto terms = static_cast<Eigen::Index>(basis_.terms().size()), m = 2 * terms;
    Eigen::MatrixXd out(m + 1, m + 1);
    for (Eigen::Index q = 0; q < terms; ++q) {
      for (Eigen::Index r = q; r < terms; ++r) {
        const Complex sum = product(q, r);
        out(2 * q, 2 * r) = out(2 * q + 1, 2 * r + 1) = sum.real();
        out(2 * q, 2 * r + 1) = -sum.imag(); // column 2r + 1 is j times column 2r
        out(2 * q + 1, 2 * r) = sum.imag();
      }
      const Complex sum = with_residual(q);
      out(2 * q, m) = sum.real();
      out(2 * q + 1, m) = sum.imag();
    }
    out(m, m) = sums_.squares;
    out.triangularView<Eigen::StrictlyLower>() = out.transpose();
    return out;
  }

private:
  /// factor times function (-1: none) times e^(j exponent x).
  struct Piece {
    int exponent;
    Complex factor;
    int function;
  };

  struct Tables {
    Eigen::VectorXcd plain;                      ///< sums of e^(j k x), by k
    Eigen::MatrixXcd mixed;                      ///< the same with each function, by function and k
    std::map<int, Eigen::MatrixXcd> between;     ///< with each pair of functions, by k
    Eigen::VectorXcd of_plain;                   ///< of the residual times e^(-j k x)
    std::map<int, Eigen::VectorXcd> of_function; ///< and with each function
    double squares = 0.0;

    Tables &operator+=(const Tables &other) {
      plain += other.plain;
      mixed += other.mixed;
      for (auto &[k, sum] : between)
        sum += other.between.at(k);
      of_plain += other.of_plain;
      for (auto &[k, sum] : of_function)
        sum += other.of_function.at(k);
      squares += other.squares;
      return *this;
    }
  };

  Tables nothing() const {
    const auto functions = static_cast<Eigen::Index>(functions_.size());
    Tables out;
    out.plain = Eigen::VectorXcd::Zero(span_plain_ + 1);
    out.mixed = Eigen::MatrixXcd::Zero(functions, span_mixed_ + 1);
    out.of_plain = Eigen::VectorXcd::Zero(2 * highest_plain_ + 1);
    for (int a : exponents_) {
      out.of_function[a] = Eigen::VectorXcd::Zero(functions);
      for (int b : exponents_)
        if (b >= a)
          out.between[b - a] = Eigen::MatrixXcd::Zero(functions, functions);
    }
    return out;
  }

  void take_apart() {
    int highest_mixed = 0;
    for (Basis::Term t : basis_.terms()) {
      t.exponent /= unit_;
      Modulation by = t.modulation;
      if (by.of_angle())
        by.order /= unit_;
      const Complex half_j(0.0, 0.5);
      if (by.kind == Modulation::angle_cos)
        pieces_.push_back({{t.exponent + by.order, 0.5, -1}, {t.exponent - by.order, 0.5, -1}});
      else if (by.kind == Modulation::angle_sin)
        pieces_.push_back(
            {{t.exponent + by.order, -half_j, -1}, {t.exponent - by.order, half_j, -1}});
      else if (by.kind == Modulation::none)
        pieces_.push_back({{t.exponent, 1.0, -1}});
      else {
        auto at = std::find(functions_.begin(), functions_.end(), by);
        if (at == functions_.end())
          at = functions_.insert(functions_.end(), by);
        pieces_.push_back({{t.exponent, 1.0, static_cast<int>(at - functions_.begin())}});
        highest_mixed = std::max(highest_mixed, std::abs(t.exponent));
        exponents_.push_back(t.exponent);
      }
      for (const Piece &p : pieces_.back())
        if (p.function < 0)
          highest_plain_ = std::max(highest_plain_, std::abs(p.exponent));
    }
    std::sort(exponents_.begin(), exponents_.end());
    exponents_.erase(std::unique(exponents_.begin(), exponents_.end()), exponents_.end());
    span_plain_ = 2 * highest_plain_;
    span_mixed_ = highest_plain_ + highest_mixed;
  }

  void add(const Observations &data, const ResidualColumns &left, std::size_t first, std::size_t n,
           Tables &sums) const {
    const auto samples = static_cast<Eigen::Index>(n);
    const int span = std::max(
        {span_plain_, span_mixed_, sums.between.empty() ? 0 : sums.between.rbegin()->first});
    Eigen::MatrixXd cosine(samples, span + 1), sine(samples, span + 1);
    Eigen::VectorXcd residual(samples);
    Eigen::MatrixXd function(samples, static_cast<Eigen::Index>(functions_.size()));
    Eigen::VectorXcd unit(samples), power = Eigen::VectorXcd::Ones(samples);
    for (Eigen::Index i = 0; i < samples; ++i) {
      const std::size_t at = first + static_cast<std::size_t>(i);
      unit[i] = std::polar(1.0, unit_ * basis_.angle(data, at));
      residual[i] = {left.cos[at], left.sin[at]};
      for (std::size_t f = 0; f < functions_.size(); ++f)
        function(i, static_cast<Eigen::Index>(f)) = basis_.function(functions_[f], data, at);
    }
    for (int k = 0; k <= span; ++k) {
      cosine.col(k) = power.real();
      sine.col(k) = power.imag();
      power = power.cwiseProduct(unit).eval();
    }
    const auto turned = [&](int k) -> Eigen::VectorXcd { // e^(j k x)
      const double sign = k < 0 ? -1.0 : 1.0;
      return cosine.col(std::abs(k)).cast<Complex>() + Complex(0.0, sign) * sine.col(std::abs(k));
    };
    for (int k = 0; k <= span_plain_; ++k)
      sums.plain[k] += Complex(cosine.col(k).sum(), sine.col(k).sum());
    sums.mixed.real() += function.transpose() * cosine.leftCols(span_mixed_ + 1);
    sums.mixed.imag() += function.transpose() * sine.leftCols(span_mixed_ + 1);
    for (auto &[k, sum] : sums.between) {
      sum.real() += function.transpose() * (cosine.col(k).asDiagonal() * function);
      sum.imag() += function.transpose() * (sine.col(k).asDiagonal() * function);
    }
    for (int k = -highest_plain_; k <= highest_plain_; ++k)
      sums.of_plain[k + highest_plain_] += turned(k).dot(residual);
    for (auto &[k, sum] : sums.of_function)
      sum += function.transpose() * turned(k).conjugate().cwiseProduct(residual);
    sums.squares += residual.squaredNorm();
  }

  /// Sum over the samples of conj(q) r, q and r two terms.
  Complex product(Eigen::Index q, Eigen::Index r) const {
    Complex sum = 0.0;
    for (const Piece &a : pieces_[static_cast<std::size_t>(q)])
      for (const Piece &b : pieces_[static_cast<std::size_t>(r)])
        sum += std::conj(a.factor) * b.factor *
               between(a.function, b.function, b.exponent - a.exponent);
    return sum;
  }

  Complex between(int f, int g, int k) const {
    const int up = std::abs(k);
    const Complex sum = f < 0 && g < 0 ? sums_.plain[up]
                        : f < 0        ? sums_.mixed(g, up)
                        : g < 0        ? sums_.mixed(f, up)
                                       : sums_.between.at(up)(f, g);
    return k < 0 ? std::conj(sum) : sum; // the functions are real
  }

  Complex with_residual(Eigen::Index q) const {
    Complex sum = 0.0;
    for (const Piece &a : pieces_[static_cast<std::size_t>(q)])
      sum += std::conj(a.factor) * (a.function < 0 ? sums_.of_plain[a.exponent + highest_plain_]
                                                   : sums_.of_function.at(a.exponent)[a.function]);
    return sum;
  }

  const Basis &basis_;
  const int unit_ = basis_.unit();         ///< of the exponents of the pieces
  std::vector<std::vector<Piece>> pieces_; ///< of each term
  std::vector<Modulation> functions_;
  std::vector<int> exponents_; ///< of the terms with a function
  int highest_plain_ = 0, span_plain_ = 0, span_mixed_ = 0;
  Tables sums_;
};

/// Column by column, where residual and columns alike go through the weights of the data.
Eigen::MatrixXd weighted_gram(const Basis &basis, const Observations &data,
                              const ResidualColumns &left) {
  const auto m = static_cast<Eigen::Index>(basis.columns());
  const Eigen::MatrixXd none = Eigen::MatrixXd::Zero(m + 1, m + 1);
  const auto add = [&](Eigen::MatrixXd &sum, std::size_t first, std::size_t n) {
    Eigen::MatrixXd rows(m + 1, static_cast<Eigen::Index>(2 * n));
    basis.evaluate(data, first, n, rows.topRows(m));
    for (std::size_t i = 0; i < n; ++i) {
      const auto s = static_cast<Eigen::Index>(2 * i);
      rows(m, s) = left.sin[first + i];
      rows(m, s + 1) = left.cos[first + i];
      const auto whiten =
          data.whitener_at(first + i, left.model_sin[first + i], left.model_cos[first + i]);
      for (Eigen::Index k = 0; k <= m; ++k)
        whiten(rows(k, s), rows(k, s + 1));
    }
    add_squares(rows, sum);
  };
  Eigen::MatrixXd out = sum_over(data.size(), none, add);
  out.triangularView<Eigen::StrictlyUpper>() = out.transpose();
  return out;
}

} // namespace

Eigen::MatrixXd gram_of(const Basis &basis, const Observations &data, const ResidualColumns &left) {
  return data.weight_along == 1.0 ? Sums(basis, data, left).gram()
                                  : weighted_gram(basis, data, left);
}

} // namespace ada
