// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/anonymous/turned_sums.h"

#include <algorithm>
#include <complex>
#include <map>

#include "base/products.h"
#include "diagnosis/anonymous/column_sums.h"
#include "diagnosis/over_samples.h"

namespace ada {

namespace {

using Complex = std::complex<double>;

/// Sums of a complex weight times the cosine and the sine of k x, each row a quantity: enough
/// for e^(j k x) and e^(-j k x) alike.
struct Turned {
  Eigen::MatrixXd real_cos, imag_cos, real_sin, imag_sin;
  Turned() = default;
  Turned(Eigen::Index rows, Eigen::Index columns)
      : real_cos(Eigen::MatrixXd::Zero(rows, columns)), imag_cos(real_cos), real_sin(real_cos),
        imag_sin(real_cos) {}
  Turned &operator+=(const Turned &other) {
    real_cos += other.real_cos;
    imag_cos += other.imag_cos;
    real_sin += other.real_sin;
    imag_sin += other.imag_sin;
    return *this;
  }
  void add(const Eigen::Ref<const Eigen::MatrixXd> &real,
           const Eigen::Ref<const Eigen::MatrixXd> &imag,
           const Eigen::Ref<const Eigen::MatrixXd> &cosine,
           const Eigen::Ref<const Eigen::MatrixXd> &sine) {
    add_products(real, cosine, real_cos);
    add_products(imag, cosine, imag_cos);
    add_products(real, sine, real_sin);
    add_products(imag, sine, imag_sin);
  }
  /// With e^(j sign k x), sign -1 or 1, of the entry of k.
  Complex at(Eigen::Index row, Eigen::Index column, double sign) const {
    return {real_cos(row, column) - sign * imag_sin(row, column),
            imag_cos(row, column) + sign * real_sin(row, column)};
  }
};

/// V is the weight; R the residual.
struct Tables {
  Turned plain;                  ///< of V and of V R, by k
  Turned mixed, with_left;       ///< of V, and of V R, times each function, by k
  std::map<int, Turned> between; ///< of V times two functions, by k
  double squares = 0.0;          ///< Re of V R^2
  Tables &operator+=(const Tables &other) {
    plain += other.plain;
    mixed += other.mixed;
    with_left += other.with_left;
    for (auto &[k, sum] : between)
      sum += other.between.at(k);
    squares += other.squares;
    return *this;
  }
};

class TurnedSums {
public:
  TurnedSums(const Basis &basis, const Pieces &pieces, const Observations &data,
             const ResidualColumns &left, const Eigen::MatrixXd &values)
      : pieces_(pieces) {
    const int p = pieces.highest_plain, m = pieces.highest_mixed;
    const auto functions = static_cast<Eigen::Index>(pieces.functions.size());
    Tables zero;
    zero.plain = Turned(2, 2 * p + 1);
    zero.mixed = Turned(functions, p + m + 1);
    zero.with_left = Turned(functions, m + 1);
    for (int a : pieces.exponents)
      for (int b : pieces.exponents)
        zero.between.try_emplace(std::abs(a + b), functions, functions);
    tables_ = sum_over(data.size(), zero, [&](Tables &sums, std::size_t first, std::size_t n) {
      add(basis, data, left, values, first, n, sums);
    });
  }

  Eigen::MatrixXd gram() const {
    const auto terms = static_cast<Eigen::Index>(pieces_.of_term.size()), m = 2 * terms;
    Eigen::MatrixXd out(m + 1, m + 1);
    for (Eigen::Index q = 0; q < terms; ++q) {
      for (Eigen::Index r = q; r < terms; ++r) {
        const Complex sum = product(q, r); // column 2q + 1 is j times column 2q
        out(2 * q, 2 * r) = sum.real();
        out(2 * q, 2 * r + 1) = out(2 * q + 1, 2 * r) = -sum.imag();
        out(2 * q + 1, 2 * r + 1) = -sum.real();
      }
      const Complex sum = with_residual(q);
      out(2 * q, m) = sum.real();
      out(2 * q + 1, m) = -sum.imag();
    }
    out(m, m) = tables_.squares;
    out.triangularView<Eigen::StrictlyLower>() = out.transpose();
    return out;
  }

private:
  void add(const Basis &basis, const Observations &data, const ResidualColumns &left,
           const Eigen::MatrixXd &all_values, std::size_t first, std::size_t n,
           Tables &sums) const {
    const auto at = static_cast<Eigen::Index>(first), samples = static_cast<Eigen::Index>(n);
    Eigen::VectorXd angles(samples);
    Eigen::MatrixXd real(2, samples), imag(2, samples); // V and V R
    for (Eigen::Index i = 0; i < samples; ++i) {
      const std::size_t k = first + static_cast<std::size_t>(i);
      angles[i] = pieces_.unit * basis.angle(data, k);
      const auto [us, uc] = data.direction_at(k, left.model_sin[k], left.model_cos[k]);
      const Complex v = std::pow(Complex(uc, -us), 2), r(left.cos[k], left.sin[k]), vr = v * r;
      real(0, i) = v.real();
      imag(0, i) = v.imag();
      real(1, i) = vr.real();
      imag(1, i) = vr.imag();
      sums.squares += (vr * r).real();
    }
    const Eigen::Index plain = sums.plain.real_cos.cols(), mixed = sums.mixed.real_cos.cols();
    Eigen::MatrixXd cosine(std::max(plain, mixed), samples), sine(cosine.rows(), samples);
    powers(angles, cosine, sine);
    sums.plain.add(real, imag, cosine.topRows(plain), sine.topRows(plain));
    if (pieces_.functions.empty())
      return;
    const auto values = all_values.middleCols(at, samples);
    const auto times = [&](const Eigen::MatrixXd &of, Eigen::Index row) -> Eigen::MatrixXd {
      return values * of.row(row).asDiagonal();
    };
    const Eigen::MatrixXd v_real = times(real, 0), v_imag = times(imag, 0);
    sums.mixed.add(v_real, v_imag, cosine.topRows(mixed), sine.topRows(mixed));
    const Eigen::Index own = sums.with_left.real_cos.cols();
    sums.with_left.add(times(real, 1), times(imag, 1), cosine.topRows(own), sine.topRows(own));
    for (auto &[k, sum] : sums.between)
      sum.add(v_real, v_imag, times(cosine, k), times(sine, k));
  }

  static double sign(int k) { return k < 0 ? -1.0 : 1.0; }

  /// Sum over the samples of V q r, q and r two terms.
  Complex product(Eigen::Index q, Eigen::Index r) const {
    Complex sum = 0.0;
    for (const Pieces::Piece &a : pieces_.of_term[static_cast<std::size_t>(q)])
      for (const Pieces::Piece &b : pieces_.of_term[static_cast<std::size_t>(r)]) {
        const int k = a.exponent + b.exponent, up = std::abs(k);
        const Complex of = a.function < 0 && b.function < 0 ? tables_.plain.at(0, up, sign(k))
                           : a.function < 0 ? tables_.mixed.at(b.function, up, sign(k))
                           : b.function < 0
                               ? tables_.mixed.at(a.function, up, sign(k))
                               : tables_.between.at(up).at(a.function, b.function, sign(k));
        sum += a.factor * b.factor * of;
      }
    return sum;
  }

  Complex with_residual(Eigen::Index q) const {
    Complex sum = 0.0;
    for (const Pieces::Piece &a : pieces_.of_term[static_cast<std::size_t>(q)]) {
      const int up = std::abs(a.exponent);
      sum += a.factor * (a.function < 0 ? tables_.plain.at(1, up, sign(a.exponent))
                                        : tables_.with_left.at(a.function, up, sign(a.exponent)));
    }
    return sum;
  }

  const Pieces &pieces_;
  Tables tables_;
};

} // namespace

Eigen::MatrixXd turned_gram(const Basis &basis, const Pieces &pieces, const Observations &data,
                            const ResidualColumns &left, const Eigen::MatrixXd &values) {
  return TurnedSums(basis, pieces, data, left, values).gram();
}

} // namespace ada
