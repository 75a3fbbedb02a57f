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
#include "diagnosis/anonymous/column_sums.h"
#include "diagnosis/anonymous/regression.h"
#include "diagnosis/over_samples.h"

namespace ada {

namespace {

using Complex = std::complex<double>;

class Sums {
public:
  Sums(const Basis &basis, const Observations &data, const ResidualColumns &left, ColumnSums &known)
      : basis_(basis), known_(known) {
    take_apart();
    known_.need({basis, data, unit_, functions_, 2 * highest_plain_,
                 highest_plain_ + highest_mixed_, pairs()});
    for (const Modulation &f : functions_)
      places_.push_back(known_.place_of(f));
    for (int k = 0; k <= 2 * std::max(highest_plain_, highest_mixed_); ++k)
      turns_.push_back(std::polar(1.0, k * unit_ * basis_.zero_rad()));
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

  /// Sums with the residual.
  struct Tables {
    Eigen::MatrixXcd of_plain;                   ///< times cosine and sine of k x
    std::map<int, Eigen::VectorXcd> of_function; ///< times each function and e^(-j k x)
    double squares = 0.0;

    Tables &operator+=(const Tables &other) {
      of_plain += other.of_plain;
      for (auto &[k, sum] : of_function)
        sum += other.of_function.at(k);
      squares += other.squares;
      return *this;
    }
  };

  Tables nothing() const {
    Tables out;
    out.of_plain = Eigen::MatrixXcd::Zero(highest_plain_ + 1, 2);
    for (int a : exponents_)
      out.of_function[a] = Eigen::VectorXcd::Zero(known_.values().rows());
    return out;
  }

  void take_apart() {
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
        highest_mixed_ = std::max(highest_mixed_, std::abs(t.exponent));
        exponents_.push_back(t.exponent);
      }
      for (const Piece &p : pieces_.back())
        if (p.function < 0)
          highest_plain_ = std::max(highest_plain_, std::abs(p.exponent));
    }
    std::sort(exponents_.begin(), exponents_.end());
    exponents_.erase(std::unique(exponents_.begin(), exponents_.end()), exponents_.end());
  }

  std::vector<int> pairs() const {
    std::vector<int> out;
    for (int a : exponents_)
      for (int b : exponents_)
        if (b >= a)
          out.push_back(b - a);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  void add(const Observations &data, const ResidualColumns &left, std::size_t first, std::size_t n,
           Tables &sums) const {
    const auto at = static_cast<Eigen::Index>(first), samples = static_cast<Eigen::Index>(n);
    const Eigen::Index span = std::max(highest_plain_, highest_mixed_) + 1;
    Eigen::VectorXd angles(samples);
    Eigen::MatrixXd residual(2, samples), cosine(span, samples), sine(span, samples);
    for (Eigen::Index i = 0; i < samples; ++i) {
      const std::size_t k = first + static_cast<std::size_t>(i);
      angles[i] = unit_ * basis_.angle(data, k);
      residual(0, i) = left.cos[k];
      residual(1, i) = left.sin[k];
    }
    powers(angles, cosine, sine);
    const Eigen::Index plain = highest_plain_ + 1;
    sums.of_plain.col(0).real() += cosine.topRows(plain) * residual.row(0).transpose();
    sums.of_plain.col(0).imag() += cosine.topRows(plain) * residual.row(1).transpose();
    sums.of_plain.col(1).real() += sine.topRows(plain) * residual.row(0).transpose();
    sums.of_plain.col(1).imag() += sine.topRows(plain) * residual.row(1).transpose();
    const auto values = known_.values().middleCols(at, samples);
    for (auto &[k, sum] : sums.of_function) { // e^(-j k x) times the residual
      const Eigen::VectorXd c = cosine.row(std::abs(k)),
                            s = (k < 0 ? -1.0 : 1.0) * sine.row(std::abs(k));
      const Eigen::VectorXd x = residual.row(0), y = residual.row(1);
      sum.real() += values * (c.cwiseProduct(x) + s.cwiseProduct(y));
      sum.imag() += values * (c.cwiseProduct(y) - s.cwiseProduct(x));
    }
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
    const auto place = [&](int of) { return places_[static_cast<std::size_t>(of)]; };
    const int up = std::abs(k);
    Complex sum = f < 0 && g < 0 ? known_.plain(up)
                  : f < 0        ? known_.mixed(place(g), up)
                  : g < 0        ? known_.mixed(place(f), up)
                                 : known_.between(place(f), place(g), up);
    if (k < 0)
      sum = std::conj(sum); // the functions are real
    return sum * (k < 0 ? std::conj(turns_[static_cast<std::size_t>(up)])
                        : turns_[static_cast<std::size_t>(up)]);
  }

  Complex with_residual(Eigen::Index q) const {
    Complex sum = 0.0;
    for (const Piece &a : pieces_[static_cast<std::size_t>(q)]) {
      const Eigen::Index up = std::abs(a.exponent);
      const Complex with_sine = Complex(0.0, a.exponent < 0 ? 1.0 : -1.0) * sums_of(up, 1);
      sum += std::conj(a.factor) *
             (a.function < 0 ? sums_of(up, 0) + with_sine
                             : sums_.of_function.at(a.exponent)[static_cast<Eigen::Index>(
                                   places_[static_cast<std::size_t>(a.function)])]);
    }
    return sum;
  }
  Complex sums_of(Eigen::Index k, Eigen::Index part) const {
    return k < sums_.of_plain.rows() ? sums_.of_plain(k, part) : Complex(0.0);
  }

  const Basis &basis_;
  ColumnSums &known_;
  const int unit_ = basis_.unit();         ///< of the exponents of the pieces
  std::vector<std::vector<Piece>> pieces_; ///< of each term
  std::vector<Modulation> functions_;
  std::vector<std::size_t> places_; ///< of the functions among the known
  /// What is known is of the angle without the zero of the basis: by the exponent, its turn by
  /// that.
  std::vector<Complex> turns_;
  std::vector<int> exponents_; ///< of the terms with a function
  int highest_plain_ = 0, highest_mixed_ = 0;
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

Eigen::MatrixXd gram_of(const Basis &basis, const Observations &data, const ResidualColumns &left,
                        ColumnSums *known) {
  if (data.weight_along != 1.0)
    return weighted_gram(basis, data, left);
  ColumnSums none;
  return Sums(basis, data, left, known ? *known : none).gram();
}

} // namespace ada
