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

#include "diagnosis/anonymous/column_sums.h"
#include "diagnosis/anonymous/pieces.h"
#include "diagnosis/anonymous/regression.h"
#include "diagnosis/anonymous/turned_sums.h"
#include "diagnosis/over_samples.h"

namespace ada {

namespace {

using Complex = std::complex<double>;

class BinnedSums {
public:
  BinnedSums(const Basis &basis, const Pieces &pieces, const Observations &data,
             const ResidualColumns &left, ColumnSums &known)
      : basis_(basis), pieces_(pieces), known_(known) {
    known_.need({basis, data, pieces_.unit, pieces_.functions, 2 * pieces_.highest_plain,
                 pieces_.highest_plain + pieces_.highest_mixed, pairs()});
    for (const Modulation &f : pieces_.functions)
      places_.push_back(static_cast<Eigen::Index>(known_.place_of(f)));
    for (int k = 0; k <= 2 * highest(); ++k)
      turns_.push_back(std::polar(1.0, k * pieces_.unit * basis_.zero_rad()));
    sums_ = sum_over(data.size(), nothing(), [&](Tables &sums, std::size_t first, std::size_t n) {
      add(data, left, first, n, sums);
    });
  }

  /// Values of the functions of the pieces.
  Eigen::MatrixXd values() const { return known_.values()(places_, Eigen::all); }

  Eigen::MatrixXd gram() const {
    const auto terms = static_cast<Eigen::Index>(pieces_.of_term.size()), m = 2 * terms;
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
    out.of_plain = Eigen::MatrixXcd::Zero(pieces_.highest_plain + 1, 2);
    for (int a : pieces_.exponents)
      out.of_function[a] = Eigen::VectorXcd::Zero(known_.values().rows());
    return out;
  }

  int highest() const { return std::max(pieces_.highest_plain, pieces_.highest_mixed); }

  std::vector<int> pairs() const {
    std::vector<int> out;
    for (int a : pieces_.exponents)
      for (int b : pieces_.exponents)
        if (b >= a)
          out.push_back(b - a);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  void add(const Observations &data, const ResidualColumns &left, std::size_t first, std::size_t n,
           Tables &sums) const {
    const auto at = static_cast<Eigen::Index>(first), samples = static_cast<Eigen::Index>(n);
    const Eigen::Index span = highest() + 1;
    Eigen::VectorXd angles(samples);
    Eigen::MatrixXd residual(2, samples), cosine(span, samples), sine(span, samples);
    for (Eigen::Index i = 0; i < samples; ++i) {
      const std::size_t k = first + static_cast<std::size_t>(i);
      angles[i] = pieces_.unit * basis_.angle(data, k);
      residual(0, i) = left.cos[k];
      residual(1, i) = left.sin[k];
    }
    powers(angles, cosine, sine);
    const Eigen::Index plain = pieces_.highest_plain + 1;
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
    for (const Pieces::Piece &a : pieces_.of_term[static_cast<std::size_t>(q)])
      for (const Pieces::Piece &b : pieces_.of_term[static_cast<std::size_t>(r)])
        sum += std::conj(a.factor) * b.factor *
               between(a.function, b.function, b.exponent - a.exponent);
    return sum;
  }

  Complex between(int f, int g, int k) const {
    const auto place = [&](int of) {
      return static_cast<std::size_t>(places_[static_cast<std::size_t>(of)]);
    };
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
    for (const Pieces::Piece &a : pieces_.of_term[static_cast<std::size_t>(q)]) {
      const Eigen::Index up = std::abs(a.exponent);
      const Complex with_sine = Complex(0.0, a.exponent < 0 ? 1.0 : -1.0) * sums_of(up, 1);
      sum +=
          std::conj(a.factor) *
          (a.function < 0
               ? sums_of(up, 0) + with_sine
               : sums_.of_function.at(a.exponent)[places_[static_cast<std::size_t>(a.function)]]);
    }
    return sum;
  }
  Complex sums_of(Eigen::Index k, Eigen::Index part) const {
    return k < sums_.of_plain.rows() ? sums_.of_plain(k, part) : Complex(0.0);
  }

  const Basis &basis_;
  const Pieces &pieces_;
  ColumnSums &known_;
  std::vector<Eigen::Index> places_; ///< of the functions among the known
  /// What is known is of the angle without the zero of the basis: by the exponent, its turn by
  /// that.
  std::vector<Complex> turns_;
  Tables sums_;
};

} // namespace

Eigen::MatrixXd gram_of(const Basis &basis, const Observations &data, const ResidualColumns &left,
                        ColumnSums *known) {
  ColumnSums none;
  const Pieces pieces(basis);
  const BinnedSums sums(basis, pieces, data, left, known ? *known : none);
  Eigen::MatrixXd out = sums.gram();
  if (data.weight_along != 1.0) {
    const double w2 = data.weight_along * data.weight_along;
    out = 0.5 * (w2 + 1.0) * out +
          0.5 * (w2 - 1.0) * turned_gram(basis, pieces, data, left, sums.values());
  }
  return out;
}

} // namespace ada
