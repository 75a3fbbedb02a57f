// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/anonymous/regression.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Dense>

#include "diagnosis/anonymous/column_sums.h"
#include "diagnosis/anonymous/pieces.h"
#include "diagnosis/criteria.h"
#include "diagnosis/over_samples.h"

namespace ada {

Eigen::MatrixXd ridged(Eigen::MatrixXd gram, double ridge, const Eigen::VectorXd &stiffness,
                       double n) {
  gram.diagonal().array() =
      gram.diagonal().array() * (1.0 + ridge * stiffness.array()) + criteria::kRidge * n;
  return gram;
}

namespace {

/// Least squares with nested sets of columns: the first k of one order, for every k. One Cholesky
/// decomposition of the whole holds those of all leading parts.
class Nested {
public:
  /// `left`: about the part of the sum of squares that these columns leave. `known_ridge`:
  /// from elsewhere.
  Nested(const Products &from, std::vector<Eigen::Index> columns, const Eigen::VectorXd &stiffness,
         double left = 1.0, std::optional<double> known_ridge = std::nullopt)
      : from_(from), columns_(std::move(columns)), stiffness_(stiffness(columns_)), left_(left) {
    train_ = from_.train(columns_, columns_);
    train_onto_ = from_.train(columns_, from_.train.rows() - 1);
    if (known_ridge) {
      decompose(*known_ridge);
      return;
    }
    // Of many columns the first few say about what all of them will leave.
    constexpr std::size_t kFew = 64;
    if (columns_.size() > 2 * kFew)
      left_ = Nested(from, first(kFew), stiffness, left_).left();
    const double n = std::max(1.0, from.n_train), k = stiffness_.cwiseInverse().sum();
    const Eigen::Index last = from.train.rows() - 1;
    const double all = std::max(from.train(last, last), 1e-300);
    // What is to be explained is taken as spread over all columns by their stiffness: that is the
    // variance which each coefficient may have before any data (empirical Bayes). It matters only
    // where the data tell little. What is left, the noise, is known once the fit is: four passes
    // settle it, or as many as still move it by a tenth: the variance of a hundred coefficients is
    // known to a seventh.
    constexpr double kSettled = 0.1;
    for (int pass = 0; pass < 4; ++pass) {
      const double ridge = std::max(criteria::kRidge, left_ * k / n);
      if (std::abs(ridge - ridge_) <= kSettled * ridge_)
        break;
      decompose(ridge);
      left_ = std::min(1.0, train(columns_.size()) / all / (1.0 - criteria::kMostColumns));
    }
  }

  double ridge() const { return ridge_; }
  double left() const { return left_; }
  /// Sum of squares of the training part with the first `k` columns.
  double train(std::size_t k) const {
    const Eigen::Index last = from_.train.rows() - 1;
    const auto m = static_cast<Eigen::Index>(k);
    return std::max(0.0, from_.train(last, last) - forward_.head(m).squaredNorm());
  }
  Eigen::VectorXd values(std::size_t k) const {
    const auto m = static_cast<Eigen::Index>(k);
    return factor_.topLeftCorner(m, m).transpose().triangularView<Eigen::Upper>().solve(
        forward_.head(m));
  }
  /// The same of the held-out part.
  double heldout(const Eigen::VectorXd &values) {
    const Eigen::Index last = from_.heldout.rows() - 1, m = values.size();
    if (heldout_.rows() < m) {
      heldout_ = from_.heldout(columns_, columns_);
      heldout_onto_ = from_.heldout(columns_, last);
    }
    return std::max(0.0, from_.heldout(last, last) - 2.0 * values.dot(heldout_onto_.head(m)) +
                             values.dot(heldout_.topLeftCorner(m, m) * values));
  }
  std::vector<Eigen::Index> first(std::size_t k) const {
    return {columns_.begin(), columns_.begin() + static_cast<std::ptrdiff_t>(k)};
  }

private:
  void decompose(double ridge) {
    ridge_ = ridge;
    const auto m = static_cast<Eigen::Index>(columns_.size());
    factor_ = ridged(train_, ridge, stiffness_, from_.n_train);
    Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> in_place(factor_);
    forward_ = m == 0 ? train_onto_
                      : Eigen::VectorXd(factor_.triangularView<Eigen::Lower>().solve(train_onto_));
  }

  const Products &from_;
  std::vector<Eigen::Index> columns_;
  Eigen::VectorXd stiffness_;
  double left_, ridge_ = 0.0;
  Eigen::MatrixXd train_; ///< products of the training part in the order of the columns
  Eigen::VectorXd train_onto_;
  Eigen::MatrixXd factor_;  ///< lower triangle
  Eigen::VectorXd forward_; ///< its inverse times the products with the residual
  /// Products of the held-out part in the order of the columns, once they are asked for.
  Eigen::MatrixXd heldout_;
  Eigen::VectorXd heldout_onto_;
};

/// Steps come first of all columns. What each axis explains is counted in the order of the axes all
/// the same: what an axis before that of the time explains as well is its own. `before`: held-out
/// sum of squares of the baseline.
void share_in_order(const Basis &basis, const Products &from, double before, Selection &out) {
  const auto axis_of = [&](Eigen::Index column) {
    for (const Group &g : basis.groups())
      if (column >= static_cast<Eigen::Index>(g.first) &&
          column < static_cast<Eigen::Index>(g.first + g.count))
        return g.order == kOfBaseline ? -1 : static_cast<int>(g.axis);
    return -1;
  };
  std::vector<Eigen::Index> columns = out.columns;
  std::stable_sort(columns.begin(), columns.end(),
                   [&](Eigen::Index a, Eigen::Index b) { return axis_of(a) < axis_of(b); });
  Nested nested(from, columns, basis.stiffness(), 1.0, out.ridge);
  out.share_v2.fill(0.0);
  for (std::size_t k = 0; k < columns.size();) {
    const int axis = axis_of(columns[k]);
    while (k < columns.size() && axis_of(columns[k]) == axis)
      ++k;
    const double left = nested.heldout(nested.values(k));
    if (axis >= 0)
      out.share_v2[static_cast<std::size_t>(axis)] = std::max(0.0, before - left) / from.n_heldout;
    before = std::min(before, left);
  }
  out.steps_v2 = std::min(out.steps_v2, out.share_v2[static_cast<std::size_t>(Axis::time)]);
}

/// Orders the groups of steps so that each is the one that held-out data need most beside those
/// before it: they have no order of their own, and one that is none in front of the others would
/// be taken with them.
void best_first(const Products &from, const Eigen::VectorXd &stiffness,
                std::vector<Eigen::Index> columns, std::vector<const Group *> &groups) {
  std::vector<const Group *> sorted;
  while (!groups.empty()) {
    int best = groups.front()->order;
    std::vector<Eigen::Index> with_best;
    double least = std::numeric_limits<double>::infinity();
    for (auto g = groups.begin(); g != groups.end();) {
      const int order = (*g)->order;
      std::vector<Eigen::Index> with = columns;
      for (; g != groups.end() && (*g)->order == order; ++g)
        for (std::size_t k = 0; k < (*g)->count; ++k)
          with.push_back(static_cast<Eigen::Index>((*g)->first + k));
      Nested nested(from, with, stiffness);
      if (const double heldout = nested.heldout(nested.values(with.size())); heldout < least) {
        least = heldout;
        best = order;
        with_best = std::move(with);
      }
    }
    if (!with_best.empty())
      columns = std::move(with_best);
    const auto is_best = [best](const Group *g) { return g->order == best; };
    std::ranges::copy_if(groups, std::back_inserter(sorted), is_best);
    std::erase_if(groups, is_best);
  }
  groups = std::move(sorted);
}

} // namespace

Products products(const Basis &basis, const Observations &train, const ResidualColumns &train_left,
                  const Observations &heldout, const ResidualColumns &heldout_left,
                  SumsOfHalves *known) {
  return {gram_of(basis, train, train_left, known ? &known->train : nullptr),
          gram_of(basis, heldout, heldout_left, known ? &known->heldout : nullptr),
          2.0 * static_cast<double>(train.size()), 2.0 * static_cast<double>(heldout.size())};
}

Selection select(const Basis &basis, const Products &from) {
  Selection out;
  const Eigen::Index last = from.train.rows() - 1;
  const double least = criteria::kLeastMeanSquare;
  const Eigen::VectorXd stiffness = basis.stiffness();
  double now = from.heldout(last, last);
  out.train_v2 = from.train(last, last);
  const auto nats = [&](double less, double more) {
    return 0.5 * from.told() *
           std::log((less / from.n_heldout + least) / (more / from.n_heldout + least));
  };
  std::vector<Eigen::Index> of_baseline;
  for (const Group &g : basis.groups())
    for (std::size_t k = 0; g.order == kOfBaseline && k < g.count; ++k)
      of_baseline.push_back(static_cast<Eigen::Index>(g.first + k));
  // What the baseline gains by itself is no gain of an axis.
  Nested alone(from, of_baseline, stiffness);
  double left = alone.left(); // what one axis leaves, the next begins with
  const double with_baseline = alone.heldout(alone.values(of_baseline.size()));
  // Steps come first: everything else would follow a step in part, and never to its end, while no
  // angle repeats, and no speed changes, where one was found.
  std::vector<std::pair<std::size_t, bool>> families; // axis, whether its steps
  families.emplace_back(static_cast<std::size_t>(Axis::time), true);
  for (std::size_t axis = 0; axis + 1 < kAxes; ++axis)
    families.emplace_back(axis, false);
  for (const auto &[axis, steps] : families) {
    std::vector<const Group *> groups;
    for (const Group &g : basis.groups())
      if (static_cast<std::size_t>(g.axis) == axis && g.of_step == steps && g.order != kOfBaseline)
        groups.push_back(&g);
    if (groups.empty())
      continue;
    std::stable_sort(groups.begin(), groups.end(),
                     [](const Group *a, const Group *b) { return a->order < b->order; });
    std::vector<Eigen::Index> columns = out.columns;
    double before = now;
    if (columns.empty()) { // the first axis brings it along
      columns = of_baseline;
      before = std::min(now, with_baseline);
    }
    if (steps)
      best_first(from, stiffness, columns, groups);
    std::vector<std::pair<int, std::size_t>> ends; // order, columns up to and with it
    for (const Group *g : groups) {
      if (static_cast<double>(columns.size() + g->count) > criteria::kMostColumns * from.n_train)
        break;
      for (std::size_t k = 0; k < g->count; ++k)
        columns.push_back(static_cast<Eigen::Index>(g->first + k));
      if (ends.empty() || ends.back().first != g->order)
        ends.emplace_back(g->order, 0);
      ends.back().second = columns.size();
    }
    Nested nested(from, std::move(columns), stiffness, left);
    left = nested.left();
    std::size_t best = 0;
    int best_order = 0;
    double best_gain = 0.0, best_heldout = before;
    Eigen::VectorXd best_values;
    for (std::size_t k = 0; k < ends.size(); ++k) {
      const auto &[order, end] = ends[k];
      // Each of the first eight, then in steps of an eighth: finer makes no difference.
      if (k >= 8 && k + 1 < ends.size() && (k + 1) % ((k + 1) / 8) != 0)
        continue;
      Eigen::VectorXd values = nested.values(end);
      const double heldout = nested.heldout(values);
      const double gain = nats(before, heldout);
      if (gain > best_gain + criteria::kNatsPerOrder * (best_order > 0 ? 1.0 : 0.0)) {
        best_gain = gain;
        best = end;
        best_order = order;
        best_heldout = heldout;
        best_values = std::move(values);
      }
    }
    if (best_gain < criteria::kAdmittedNats)
      continue;
    const double share_v2 = (before - best_heldout) / from.n_heldout;
    out.share_v2[axis] += share_v2;
    out.gain_nats[axis] += best_gain;
    if (steps)
      out.steps_v2 = share_v2;
    else
      out.orders[axis] = best_order;
    out.columns = nested.first(best);
    out.values = std::move(best_values);
    out.ridge = nested.ridge();
    out.train_v2 = nested.train(best);
    now = best_heldout;
  }
  if (out.steps_v2 > 0.0)
    share_in_order(basis, from, std::min(from.heldout(last, last), with_baseline), out);
  out.noise_v2 = now / std::max(1.0, from.n_heldout);
  out.train_v2 /= std::max(1.0, from.n_train - static_cast<double>(out.columns.size()));
  return out;
}

Selection select(const Basis &basis, const Products &from, std::vector<Eigen::Index> columns,
                 std::optional<double> ridge) {
  Selection out;
  Nested nested(from, columns, basis.stiffness(), 1.0, ridge);
  out.values = nested.values(columns.size());
  out.ridge = nested.ridge();
  out.noise_v2 = nested.heldout(out.values) / std::max(1.0, from.n_heldout);
  out.train_v2 = nested.train(columns.size()) /
                 std::max(1.0, from.n_train - static_cast<double>(columns.size()));
  out.columns = std::move(columns);
  return out;
}

void subtract(const Basis &basis, const Selection &selection, const Observations &data,
              ResidualColumns &residual) {
  if (selection.columns.empty())
    return;
  std::vector<std::complex<double>> of_term(basis.terms().size());
  for (std::size_t k = 0; k < selection.columns.size(); ++k) {
    const double value = selection.values[static_cast<Eigen::Index>(k)];
    of_term[static_cast<std::size_t>(selection.columns[k] / 2)] +=
        selection.columns[k] % 2 == 0 ? std::complex<double>(value, 0.0)
                                      : std::complex<double>(0.0, value);
  }
  std::vector<Eigen::Index> columns;
  for (std::size_t q = 0; q < of_term.size(); ++q)
    if (of_term[q] != 0.0)
      columns.push_back(static_cast<Eigen::Index>(2 * q));
  if (columns.empty())
    return;
  const Basis chosen = basis.part(columns);
  std::erase(of_term, std::complex<double>(0.0));
  // Of each function, and of none first, the coefficients of the cosine and of the sine of k x.
  const Pieces pieces(chosen);
  const auto functions = static_cast<Eigen::Index>(pieces.functions.size());
  const Eigen::Index mixed = pieces.highest_mixed + 1,
                     span = std::max<Eigen::Index>(pieces.highest_plain + 1, mixed);
  Eigen::MatrixXcd of_cos = Eigen::MatrixXcd::Zero(span, functions + 1), of_sin = of_cos;
  for (std::size_t q = 0; q < of_term.size(); ++q)
    for (const Pieces::Piece &p : pieces.of_term[q]) {
      const std::complex<double> value = of_term[q] * p.factor;
      const Eigen::Index k = std::abs(p.exponent), f = p.function + 1;
      of_cos(k, f) += value;
      of_sin(k, f) += value * std::complex<double>(0.0, p.exponent < 0 ? -1.0 : 1.0);
    }
  const Eigen::MatrixXd cos_real = of_cos.real(), cos_imag = of_cos.imag(),
                        sin_real = of_sin.real(), sin_imag = of_sin.imag();
  for_all_samples(data.size(), [&](std::size_t first, std::size_t n) {
    const auto samples = static_cast<Eigen::Index>(n);
    Eigen::VectorXd angles(samples);
    for (Eigen::Index i = 0; i < samples; ++i)
      angles[i] = pieces.unit * chosen.angle(data, first + static_cast<std::size_t>(i));
    Eigen::MatrixXd cosine(span, samples), sine(span, samples);
    powers(angles, cosine, sine);
    const auto sums = [&](const Eigen::MatrixXd &with_cos, const Eigen::MatrixXd &with_sin,
                          Eigen::Index rows, Eigen::Index from, Eigen::Index count) {
      return Eigen::MatrixXd(with_cos.block(0, from, rows, count).transpose() *
                                 cosine.topRows(rows) +
                             with_sin.block(0, from, rows, count).transpose() * sine.topRows(rows));
    };
    const Eigen::MatrixXd real = sums(cos_real, sin_real, span, 0, 1),
                          imag = sums(cos_imag, sin_imag, span, 0, 1),
                          f_real = sums(cos_real, sin_real, mixed, 1, functions),
                          f_imag = sums(cos_imag, sin_imag, mixed, 1, functions);
    for (std::size_t i = 0; i < n; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      double re = real(0, column), im = imag(0, column);
      for (Eigen::Index f = 0; f < functions; ++f) {
        const double g =
            chosen.function(pieces.functions[static_cast<std::size_t>(f)], data, first + i);
        re += g * f_real(f, column);
        im += g * f_imag(f, column);
      }
      residual.cos[first + i] -= re;
      residual.sin[first + i] -= im;
    }
  });
}

} // namespace ada
