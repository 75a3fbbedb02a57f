// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: The libada4571 authors

#include "diagnosis/anonymous/regression.h"

#include <algorithm>
#include <cmath>

#include "diagnosis/criteria.h"

namespace ada {

/// Residual and columns alike go through the weights of the data.
Eigen::MatrixXd gram_of(const Basis &basis, const Observations &data, const ResidualColumns &left) {
  const auto m = static_cast<Eigen::Index>(basis.columns());
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(m + 1, m + 1);
  Eigen::MatrixXd rows(m + 1, 2 * kWaveBlock);
  for (std::size_t first = 0; first < data.size(); first += kWaveBlock) {
    const std::size_t n = std::min(kWaveBlock, data.size() - first);
    basis.evaluate(data, first, n, rows.topRows(m));
    for (std::size_t i = 0; i < n; ++i) {
      const auto s = static_cast<Eigen::Index>(2 * i);
      rows(m, s) = left.sin[first + i];
      rows(m, s + 1) = left.cos[first + i];
      if (data.weight_along != 1.0)
        for (Eigen::Index k = 0; k <= m; ++k)
          data.whiten(first + i, left.model_sin[first + i], left.model_cos[first + i], rows(k, s),
                      rows(k, s + 1));
    }
    out.selfadjointView<Eigen::Lower>().rankUpdate(rows.leftCols(static_cast<Eigen::Index>(2 * n)));
  }
  out.triangularView<Eigen::StrictlyUpper>() = out.transpose();
  return out;
}

namespace {

struct Fitted {
  Eigen::VectorXd values;
  double train = 0.0, heldout = 0.0; ///< sums of squares
};

/// Least squares on the training part, judged on the other. A trace of ridge keeps columns that the
/// data cannot tell apart from running away.
Fitted fit_columns(const Products &from, const std::vector<Eigen::Index> &columns) {
  const Eigen::Index last = from.train.rows() - 1;
  Fitted out;
  out.train = from.train(last, last);
  out.heldout = from.heldout(last, last);
  if (columns.empty())
    return out;
  Eigen::MatrixXd a = from.train(columns, columns);
  a.diagonal().array() *= 1.0 + criteria::kRidge;
  a.diagonal().array() += criteria::kRidge * std::max(1.0, from.n_train);
  const Eigen::VectorXd b = from.train(columns, last);
  out.values = a.ldlt().solve(b);
  out.train -= 2.0 * out.values.dot(b) - out.values.dot(from.train(columns, columns) * out.values);
  const Eigen::VectorXd c = from.heldout(columns, last);
  out.heldout -=
      2.0 * out.values.dot(c) - out.values.dot(from.heldout(columns, columns) * out.values);
  out.train = std::max(out.train, 0.0);
  out.heldout = std::max(out.heldout, 0.0);
  return out;
}

} // namespace

Products products(const Basis &basis, const Observations &train, const ResidualColumns &train_left,
                  const Observations &heldout, const ResidualColumns &heldout_left) {
  return {gram_of(basis, train, train_left), gram_of(basis, heldout, heldout_left),
          2.0 * static_cast<double>(train.size()), 2.0 * static_cast<double>(heldout.size())};
}

Selection select(const Basis &basis, const Products &from) {
  Selection out;
  Fitted now = fit_columns(from, {});
  const double least = criteria::kLeastMeanSquare;
  const auto nats = [&](const Fitted &less, const Fitted &more) {
    return 0.5 * from.n_heldout *
           std::log((less.heldout / from.n_heldout + least) / (more.heldout / from.n_heldout + least));
  };
  for (std::size_t axis = 0; axis + 1 < kAxes; ++axis) {
    int highest = 0;
    for (const Group &g : basis.groups())
      if (static_cast<std::size_t>(g.axis) == axis)
        highest = std::max(highest, g.order);
    Fitted best = now;
    std::vector<Eigen::Index> best_columns = out.columns;
    int best_order = 0;
    double best_gain = 0.0;
    for (int order = 1; order <= highest; ++order) {
      // Every order up to eight, then in steps of a quarter: finer makes no difference.
      if (order > 8 && order != highest && order % std::max(1, order / 8) != 0)
        continue;
      std::vector<Eigen::Index> columns = out.columns;
      for (const Group &g : basis.groups())
        if (static_cast<std::size_t>(g.axis) == axis && g.order <= order)
          for (std::size_t k = 0; k < g.count; ++k)
            columns.push_back(static_cast<Eigen::Index>(g.first + k));
      if (static_cast<double>(columns.size()) > criteria::kMostColumns * from.n_train)
        break;
      Fitted trial = fit_columns(from, columns);
      const double gain = nats(now, trial);
      if (gain > best_gain + criteria::kNatsPerOrder * (best_order > 0 ? 1.0 : 0.0)) {
        best_gain = gain;
        best = std::move(trial);
        best_columns = std::move(columns);
        best_order = order;
      }
    }
    if (best_gain < criteria::kAdmittedNats)
      continue;
    out.share_v2[axis] = (now.heldout - best.heldout) / from.n_heldout;
    out.gain_nats[axis] = best_gain;
    out.orders[axis] = best_order;
    out.columns = std::move(best_columns);
    now = std::move(best);
  }
  out.values = now.values;
  out.noise_v2 = now.heldout / std::max(1.0, from.n_heldout);
  out.train_v2 = now.train / std::max(1.0, from.n_train - static_cast<double>(out.columns.size()));
  return out;
}

void subtract(const Basis &basis, const Selection &selection, const Observations &data,
              ResidualColumns &residual) {
  if (selection.columns.empty())
    return;
  const auto m = static_cast<Eigen::Index>(basis.columns());
  Eigen::VectorXd all = Eigen::VectorXd::Zero(m);
  for (std::size_t k = 0; k < selection.columns.size(); ++k)
    all[selection.columns[k]] = selection.values[static_cast<Eigen::Index>(k)];
  Eigen::MatrixXd rows(m, 2 * kWaveBlock);
  for (std::size_t first = 0; first < data.size(); first += kWaveBlock) {
    const std::size_t n = std::min(kWaveBlock, data.size() - first);
    basis.evaluate(data, first, n, rows);
    const Eigen::VectorXd part =
        rows.leftCols(static_cast<Eigen::Index>(2 * n)).transpose() * all;
    for (std::size_t i = 0; i < n; ++i) {
      residual.sin[first + i] -= part[static_cast<Eigen::Index>(2 * i)];
      residual.cos[first + i] -= part[static_cast<Eigen::Index>(2 * i + 1)];
    }
  }
}

} // namespace ada
